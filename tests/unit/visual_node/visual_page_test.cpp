#include <vector>

#include <gtest/gtest.h>

#include "common/flow.hpp"
#include "tests/unit/queue_ports.hpp"
#include "tests/unit/session_time.hpp"
#include "visual_node/visual_process.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

struct PageDisplay final : Display {
    void draw(SessionTime, const Scene&) override {}
    std::optional<ShownScene> shown(SessionTime) override { return std::nullopt; }
    SessionTime next_shown() const override { return kNever; }
    void turn_page(SessionTime, const Page& page) override { pages.push_back(page.kind); }
    void beep(SessionTime) override {}
    bool take_go_on() override { return false; }
    std::optional<GivenAnswer> take_answer() override { return std::nullopt; }
    bool take_stop() override { return false; }
    std::vector<PageKind> pages;
};

struct VisualPage : testing::Test {
    template <class Body>
    void order(int ms, std::uint32_t trial, const Body& body) {
        session.send(at(milliseconds{ms}), trial, body);
        process.tick(at(milliseconds{ms}));
    }

    QueuePorts ports;
    PageDisplay display;
    VisualProcess process{2, VisualSettings{}, ports, display};
    OutboundFlow session{Role::kSession, 1, {ports.far_end(Port::kVisualControl)}};
};

TEST_F(VisualPage, IsTurnedBetweenTrials) {
    order(1, 0, Page{.kind = PageKind::kWelcome});
    order(2, 0, Page{.kind = PageKind::kReady});
    EXPECT_EQ(display.pages, (std::vector{PageKind::kWelcome, PageKind::kReady}));
    EXPECT_EQ(process.counters().refused_total(), 0U);
}

TEST_F(VisualPage, EndsWithATrialAndNeverCoversOne) {
    order(1, 0, Page{.kind = PageKind::kReady});
    order(2, 1, SessionControl{});
    order(3, 1, Page{.kind = PageKind::kBreak});
    EXPECT_EQ(display.pages, (std::vector{PageKind::kReady, PageKind::kNone}));
}

}  // namespace
}  // namespace thimble
