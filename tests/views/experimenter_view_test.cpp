// The experimenter's view as a process: pictures by content, keys and mouse by xdotool. Its picture is known, because the session here is a demonstration.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/views/fake_session.hpp"
#include "tests/views/view_bench.hpp"
#include "visual_node/views/experimenter_panels.hpp"

namespace thimble {
namespace {

class ExperimenterView : public testing::Test {
  protected:
    void SetUp() override {
        if (const std::string missing = missing_for_windows(); !missing.empty()) GTEST_SKIP() << missing;
    }
};

// Checks that the fixture's line stands where it belongs in the side view, and nowhere else.
void expect_fixture_at_its_place(const Image& image, double scale) {
    const Rect side = experimenter_layout(image.width, image.height, scale).side_view;
    const Rect box = plot_box(side, scale);
    const double x =
        side_view_scale(box, kDemonstrationFixture_m, kDemonstrationFixture_m).x(kDemonstrationFixture_m);
    const int line =
        count_pixels(image, {std::floor(x) - 2 * scale, box.y, 4 * scale + 1, box.height}, kReddishPurple);
    EXPECT_GT(line,
              0.3 * 3 * scale * box.height);  // dashed: half of its 3 pixels, less what the needle covers
    EXPECT_EQ(count_pixels(image, box, kReddishPurple), line);
}

// Where `colour` reaches in a column of pixels, as top and bottom; an empty range without any.
std::pair<int, int> reach(const Image& image, const Rect& box, Colour colour, int from, int to) {
    std::pair<int, int> range{image.height, -1};
    for (int x = from; x < to; ++x) {
        for (int y = static_cast<int>(box.y); y < static_cast<int>(box.bottom()); ++y) {
            if (distance(image, x, y, colour) > 12) continue;
            range.first = std::min(range.first, y);
            range.second = std::max(range.second, y);
        }
    }
    return range;
}

bool alarmed(const Image& image) {
    const Rect banner = experimenter_layout(image.width, image.height, 1).banner;
    return count_pixels(image, banner, kVermillion) > banner.width * banner.height / 2;
}

void click_control(ViewBench& bench, int row, int column, int columns) {
    const Rect cell = control_cell(experimenter_layout(800, 600, 1).controls, 1, row, column, columns);
    ASSERT_TRUE(bench.screen().click(static_cast<int>(cell.x + cell.width / 2),
                                     static_cast<int>(cell.y + cell.height / 2)));
}

TEST_F(ExperimenterView, ShowsTheFixtureAtItsPlaceAndTheOscillationWhole) {
    ViewBench bench;
    FakeSession session(bench.base_port(), 1, kDemonstrationContact_s + 1);
    ASSERT_TRUE(bench.ready());
    view_sleep(2);
    const Image image = bench.end();
    ASSERT_EQ(image.width, 800);
    ASSERT_EQ(image.height, 600);
    EXPECT_FALSE(alarmed(image));
    expect_fixture_at_its_place(image, 1);
    // 15 Hz of force at 24 ms per pixel: any four columns of the last second hold a whole period, from 0.4 to 3.2 N.
    const Rect box = plot_box(experimenter_layout(800, 600, 1).plots[1], 1);
    const auto right = static_cast<int>(box.right()) - 3;
    const auto whole = reach(image, box, kBluishGreen, right - 40, right);
    ASSERT_GT(whole.second - whole.first, 15);
    for (int x = right - 40; x < right - 4; ++x) {
        const auto part = reach(image, box, kBluishGreen, x, x + 4);
        EXPECT_GT(part.second - part.first, 0.8 * (whole.second - whole.first)) << x;
    }
    // Before the view started there is nothing, and no line to it.
    EXPECT_EQ(reach(image, box, kBluishGreen, static_cast<int>(box.x), static_cast<int>(box.x) + 100).second,
              -1);
}

TEST_F(ExperimenterView, SaysInRedThatTheSessionIsSilentAndHearsTheNextOne) {
    ViewBench bench;
    {
        FakeSession session(bench.base_port(), 1, 4);
        ASSERT_TRUE(bench.ready());
        ASSERT_TRUE(bench.screen().type("p"));
        ASSERT_TRUE(wait_for(session, OrderKind::kPause));
    }
    view_sleep(1.5);  // the session has gone; the next one is another
    FakeSession next(bench.base_port(), 2, 4);
    ASSERT_TRUE(bench.screen().type("p"));  // it is not paused, and the view has seen that
    view_sleep(1);
    EXPECT_FALSE(alarmed(bench.end()));
    EXPECT_GT(next.count(OrderKind::kPause) + next.count(OrderKind::kResume), 0);
    ViewBench lonely;
    {
        FakeSession session(lonely.base_port(), 3, 4);
        ASSERT_TRUE(lonely.ready());
        view_sleep(0.5);
    }
    view_sleep(1);
    const Image silent = lonely.end();
    EXPECT_TRUE(alarmed(silent));
    expect_fixture_at_its_place(silent, 1);  // what was known last stays, and its age stands beside it
}

TEST_F(ExperimenterView, EveryKeyAsksTheSession) {
    ViewBench bench;
    FakeSession session(bench.base_port(), 1, 4);
    ASSERT_TRUE(bench.ready());
    ASSERT_TRUE(bench.screen().type("8"));
    ASSERT_TRUE(wait_for(session, OrderKind::kNetwork));
    EXPECT_EQ(session.last(OrderKind::kNetwork)->network.view(), "leo");
    view_sleep(0.1);  // until its delay shows
    // Held as a finger would: ImGui asks at each frame whether an arrow is down.
    ASSERT_TRUE(bench.screen().hand({"keydown", "Right"}));
    view_sleep(0.15);
    ASSERT_TRUE(bench.screen().hand({"keyup", "Right"}));
    ASSERT_TRUE(wait_for(session, OrderKind::kDelay));
    EXPECT_TRUE(wait_until([&] { return std::abs(session.last(OrderKind::kDelay)->value - 0.023) < 1e-9; }));
    ASSERT_TRUE(bench.screen().type("p"));
    EXPECT_TRUE(wait_for(session, OrderKind::kPause));
    view_sleep(0.3);
    ASSERT_TRUE(bench.screen().type("p"));
    EXPECT_TRUE(wait_for(session, OrderKind::kResume));
    ASSERT_TRUE(bench.screen().type("r"));
    EXPECT_TRUE(wait_for(session, OrderKind::kRepeat, 5));
    EXPECT_EQ(session.last(OrderKind::kRepeat)->trial, 4U);
    ASSERT_TRUE(bench.screen().type("xnxy"));
    EXPECT_TRUE(wait_for(session, OrderKind::kExclude, 5));
    ASSERT_TRUE(bench.screen().type("e"));
    EXPECT_TRUE(wait_for(session, OrderKind::kEndTrial));
    view_sleep(0.3);
    ASSERT_TRUE(bench.screen().type("4s"));
    ASSERT_TRUE(wait_for(session, OrderKind::kStart));
    EXPECT_EQ(session.last(OrderKind::kStart)->modality, Modality::kVF);
    view_sleep(0.5);
    EXPECT_EQ(session.count(OrderKind::kExclude), 5);  // the one that was answered with No was never sent
    EXPECT_FALSE(alarmed(bench.end()));
}

TEST_F(ExperimenterView, ButtonsAndSliderAskTheSession) {
    ViewBench bench;
    FakeSession session(bench.base_port(), 1, 4);
    ASSERT_TRUE(bench.ready());
    click_control(bench, kSliderRow, 0, 1);
    ASSERT_TRUE(wait_for(session, OrderKind::kDelay));
    EXPECT_NEAR(session.last(OrderKind::kDelay)->value, 0.25, 0.02);
    click_control(bench, kNetworkRow + 1, 2, kNetworksPerRow);
    EXPECT_TRUE(wait_until([&] {
        const auto network = session.last(OrderKind::kNetwork);
        return network && network->network.view() == "geo";
    }));
    // A machine that stalls may show the view two clicks at once. The user sees that, and clicks again.
    EXPECT_TRUE(wait_until([&] {
        click_control(bench, kModalityRow, 1, 4);
        click_control(bench, kTrialRow, 0, 3);
        const auto start = session.last(OrderKind::kStart);
        return start && start->modality == Modality::kCF;
    }));
    click_control(bench, kAfterRow, 1, 3);  // Exclude, which asks
    view_sleep(0.5);
    EXPECT_EQ(session.count(OrderKind::kExclude), 0);
    const Rect question{190, 258, 420, 84};
    const Rect yes = control_cell(question, 1, 1, 0, 2);
    ASSERT_TRUE(bench.screen().click(static_cast<int>(yes.x + 20), static_cast<int>(yes.y + 10)));
    EXPECT_TRUE(wait_for(session, OrderKind::kExclude));
}

TEST_F(ExperimenterView, SaysThatTheSessionDoesNotAnswer) {
    ViewBench bench;
    FakeSession session(bench.base_port(), 1, 4);
    session.obey(false);
    ASSERT_TRUE(bench.ready());
    ASSERT_TRUE(bench.screen().type("p"));
    ASSERT_TRUE(wait_for(session, OrderKind::kPause, 20));
    view_sleep(2.5);
    EXPECT_LE(session.count(OrderKind::kPause), 41);
    session.fail(
        "drive 3 (acting hand, index, cable 2): EMCY 0x2310 (over-current); remove the cause, then start "
        "again");
    view_sleep(0.3);
    const Image image = bench.end();
    EXPECT_TRUE(alarmed(image));
    // The device's words, black on red, over the top of the side view and no more.
    const Rect side = experimenter_layout(800, 600, 1).side_view;
    EXPECT_GT(count_pixels(image, {side.x, side.y, side.width, 10}, kVermillion), 5 * side.width);
    EXPECT_EQ(count_pixels(image, {side.x, side.y + side.height / 2, side.width, 10}, kVermillion), 0);
}

TEST_F(ExperimenterView, ListsEveryKey) {
    ViewBench bench;
    FakeSession session(bench.base_port(), 1, 4);
    ASSERT_TRUE(bench.ready());
    ASSERT_TRUE(bench.screen().type("?"));
    view_sleep(0.5);
    const Image image = bench.end();
    // The list stands in the middle, its keys in orange, one below the other.
    int lines = 0, before = 0;
    for (int y = 0; y < image.height; ++y) {
        const int now = count_pixels(image, {70, static_cast<double>(y), 100, 1}, kOrange);
        lines += now > 0 && before == 0;
        before = now;
    }
    EXPECT_GE(lines, 15);
}

TEST_F(ExperimenterView, FollowsTheWindowsSizeAndTheMonitorsScale) {
    {
        ViewBench bench;
        FakeSession session(bench.base_port(), 1, 4);
        ASSERT_TRUE(bench.ready());
        ASSERT_TRUE(bench.screen().resize(1100, 700));
        view_sleep(0.7);
        const Image image = bench.end();
        ASSERT_EQ(image.width, 1100);
        ASSERT_EQ(image.height, 700);
        expect_fixture_at_its_place(image, 1);
    }
    ViewBench twice({"--width", "600", "--height", "480", "--scale", "2"});
    FakeSession session(twice.base_port(), 1, 4);
    ASSERT_TRUE(twice.ready());
    view_sleep(0.7);
    const Image image = twice.end();
    ASSERT_EQ(image.width, 1200);
    ASSERT_EQ(image.height, 960);
    expect_fixture_at_its_place(image, 2);
}

TEST_F(ExperimenterView, WithoutScreenOrPortItSaysWhatToDo) {
    const Folder folder;
    const PortBlock ports;
    const auto run = [&](const std::string& name) {
        Child view(std::filesystem::path(THIMBLE_BIN_DIR) / "thimble-visual",
                   {"--view", "experimenter", "--base-port", std::to_string(ports.base()), "--seconds", "1"},
                   folder / name);
        return view.wait(kPatience).value_or(-1);
    };
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    EXPECT_EQ(run("no_screen"), 2);
    EXPECT_NE(read_text(folder / "no_screen").find("no screen"), std::string::npos);
    NetworkSettings network;
    network.base_port = ports.base();
    Sockets other(network);
    (void)other.inlet(Port::kExperimenterMonitor);
    EXPECT_EQ(run("no_port"), 3);
}

}  // namespace
}  // namespace thimble
