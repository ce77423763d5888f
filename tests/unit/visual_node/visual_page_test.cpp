#include <deque>
#include <vector>

#include <gtest/gtest.h>

#include "common/flow.hpp"
#include "tests/unit/session_time.hpp"
#include "visual_node/visual_process.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

// Each end receives the other end's datagrams.
struct Mailbox final : Channel {
    void send(Bytes datagram) override { waiting.emplace_back(datagram.begin(), datagram.end()); }
    Bytes take() override {
        if (waiting.empty()) return {};
        taken = std::move(waiting.front());
        waiting.pop_front();
        return taken;
    }
    std::deque<std::vector<std::uint8_t>> waiting;
    std::vector<std::uint8_t> taken;
};

// The node's messages to the session go nowhere.
struct OneWay final : Channel {
    void send(Bytes) override {}
    Bytes take() override { return orders.take(); }
    Mailbox orders;
};

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
    static Page page_of(PageKind kind) {
        Page page;
        page.kind = kind;
        return page;
    }

    OneWay control;
    Mailbox force, beep, percept;
    PageDisplay display;
    VisualProcess process{2, VisualSettings{}, {&control, &force, &beep, &percept}, display};
    OutboundFlow session{Role::kSession, 1, {&control.orders}};
};

TEST_F(VisualPage, IsTurnedBetweenTrials) {
    order(1, 0, page_of(PageKind::kWelcome));
    order(2, 0, page_of(PageKind::kReady));
    EXPECT_EQ(display.pages, (std::vector{PageKind::kWelcome, PageKind::kReady}));
    EXPECT_EQ(process.counters().refused_total(), 0U);
}

TEST_F(VisualPage, EndsWithATrialAndNeverCoversOne) {
    order(1, 0, page_of(PageKind::kReady));
    order(2, 1, SessionControl{});
    order(3, 1, page_of(PageKind::kBreak));
    EXPECT_EQ(display.pages, (std::vector{PageKind::kReady, PageKind::kNone}));
}

}  // namespace
}  // namespace thimble
