// The experimenter's view as a process: pictures by content, keys and mouse by xdotool. Its picture is known, because
// the session here is a demonstration.
#include <cmath>
#include <csignal>
#include <optional>

#include <gtest/gtest.h>

#include "common/process/child.hpp"
#include "common/runtime/wall_clock.hpp"
#include "tests/unit/views/played_session.hpp"
#include "tests/views/fake_session.hpp"
#include "tests/views/pixels.hpp"
#include "tests/window/virtual_screen.hpp"
#include "visual_node/views/experimenter_panels.hpp"
#include "visual_node/views/order_sender.hpp"
#include "visual_node/window/cutaway.hpp"
#include "visual_node/window/gui_layer.hpp"

namespace thimble {
namespace {

// The real view on the screen, a session that talks to it, and what the view's last frame shows.
class ExperimenterView : public OnAScreen {
  protected:
    // 800x600 at scale 1 unless `size` says otherwise. The session's demonstration has run for `ahead_s`.
    void begin(double ahead_s = 4,
               const std::vector<std::string>& size = {"--width", "800", "--height", "600", "--scale", "1"}) {
        folder_.emplace();
        session_.emplace(ports_.base(), ++sessions_, ahead_s);
        std::vector<std::string> arguments{
            "--role",       "experimenter",        "--base-port",      std::to_string(ports_.base()),
            "--screenshot", *folder_ / "last.png", "--die-with-parent"};
        arguments.insert(arguments.end(), size.begin(), size.end());
        view_.emplace(std::filesystem::path(THIMBLE_BIN_DIR) / "thimble-visual", arguments,
                      *folder_ / "words");
        ASSERT_TRUE(
            wait_until([this] { return read_text(*folder_ / "words").find("ready") != std::string::npos; }));
        ASSERT_TRUE(screen_->wait_for_window("Thimble, experimenter"));
    }
    // SIGTERM; the last frame. Empty if the view did not end well.
    Image end() {
        view_->signal(SIGTERM);
        return view_->wait(kPatience) == 0 ? read_png(*folder_ / "last.png") : Image{};
    }
    // Until so many orders of this kind have come.
    bool asked(OrderKind kind, int count = 1) {
        return wait_until([&] { return session_->count(kind) >= count; });
    }
    // Until the view has seen all keys and clicks so far, and has drawn a few frames since. It says this
    // order five times, 50 ms apart. Only a view that hears a session says it.
    bool handled() {
        const int before = session_->count(OrderKind::kRepeat);
        return screen_->type("r") && asked(OrderKind::kRepeat, before + kUnseenOrderTimes);
    }
    // Until the view hears its first session: before, no trial is there to be excluded.
    bool hears() {
        return wait_until(
                   [this] { return screen_->type("xy") && session_->count(OrderKind::kExclude) > 0; }) &&
               handled();
    }
    // The session goes, until the view has missed it for longer than kMonitorSilence. The view calls a silent
    // session's port ten times a second at most: so many calls take 0.9 s of its own time.
    bool falls_silent() {
        session_.reset();
        const auto port = listen_at(ports_.base() + static_cast<unsigned>(Port::kSessionOrders));
        int calls = 0;
        return wait_until([&] {
            while (!port->receive().empty()) ++calls;
            return calls >= 10;
        });
    }
    // Until the view has seen the click.
    void click_control(int row, int column, int columns) {
        const Rect cell = control_cell(experimenter_layout(800, 600, 1).controls, 1, row, column, columns);
        ASSERT_TRUE(screen_->click(static_cast<int>(cell.x + cell.width / 2),
                                   static_cast<int>(cell.y + cell.height / 2)));
        ASSERT_TRUE(handled());
    }

    PortBlock ports_;
    std::optional<Folder> folder_;
    std::uint64_t sessions_ = 0;
    std::optional<FakeSession> session_;
    std::optional<Child> view_;
};

// Checks that the fixture's line stands where it belongs in the cut-away view, and nowhere else.
void expect_fixture_at_its_place(const Image& image, double scale) {
    const CutawayPlan plan = plan_cutaway(experimenter_layout(image.width, image.height, scale).scene);
    const double wide = plan.block_right - plan.block_left;
    const Rect row{plan.area.x, std::floor(plan.y(kDemonstrationFixture_m)), plan.area.width, 3 * scale};
    const int line = count_pixels(image, row, kWallLine);
    EXPECT_GT(line, wide);  // two pixels high, and the needle covers some
    EXPECT_EQ(count_pixels(image, plan.area, kWallLine), line);
}

// Where `colour` reaches in a column of pixels, as top and bottom; an empty range without any.
std::pair<int, int> reach(const Image& image, const Rect& box, Colour colour, int from, int to) {
    std::pair<int, int> range{image.height, -1};
    for (int x = from; x < to; ++x) {
        for (int y = static_cast<int>(box.y); y < static_cast<int>(box.bottom()); ++y) {
            if (!has_colour(image, x, y, colour)) continue;
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

// 15 Hz of force at 24 ms per pixel: any four columns of the last second hold a whole period, from 0.4 to 3.2 N.
bool shows_every_period(const Image& image, const Rect& box) {
    const auto right = static_cast<int>(box.right()) - 3;
    const auto whole = reach(image, box, kBluishGreen, right - 40, right);
    bool all = whole.second - whole.first > 15;
    for (int x = right - 40; x < right - 4; ++x) {
        const auto part = reach(image, box, kBluishGreen, x, x + 4);
        all = all && part.second - part.first > 0.8 * (whole.second - whole.first);
    }
    return all;
}

// The same panels in this process, after 2 s of the demonstration by a clock of their own. Where a machine
// stalls, no curve has a gap.
Image panels_by_their_own_clock() {
    PlayedViewSession session;
    ExperimenterPanels panels(5, session.channels());
    GlWindow window({.title = "Thimble, panels under test", .vsync = false, .content_scale = 1});
    GuiLayer gui(window);
    SessionTime now{};
    for (int ms = 4; ms <= 2000; ms += 4) {
        now = at(std::chrono::milliseconds{ms});
        session.monitor = demonstration(kDemonstrationContact_s + 1 + to_seconds(now - SessionTime{}));
        session.say(now);
        panels.tick(now);
    }
    window.begin_frame(kBlack);
    gui.begin();
    panels.draw(now, {window, nullptr});
    gui.end();
    return window.read_pixels();
}

TEST_F(ExperimenterView, ShowsTheFixtureAtItsPlace) {
    begin(kDemonstrationContact_s + 1);
    ASSERT_TRUE(hears());
    const Image image = end();
    ASSERT_EQ(image.width, 800);
    ASSERT_EQ(image.height, 600);
    EXPECT_FALSE(alarmed(image));
    expect_fixture_at_its_place(image, 1);
}

TEST_F(ExperimenterView, ShowsTheOscillationWhole) {
    const Rect box = plot_box(experimenter_layout(800, 600, 1).plots[1], 1);
    const Image image = panels_by_their_own_clock();
    ASSERT_EQ(image.width, 800);
    ASSERT_EQ(image.height, 600);
    EXPECT_FALSE(alarmed(image));
    EXPECT_TRUE(shows_every_period(image, box));
    // Before the view started there is nothing, and no line to it.
    EXPECT_EQ(reach(image, box, kBluishGreen, static_cast<int>(box.x), static_cast<int>(box.x) + 100).second,
              -1);
}

TEST_F(ExperimenterView, SaysInRedThatTheSessionIsSilentAndHearsTheNextOne) {
    begin();
    ASSERT_TRUE(hears());
    ASSERT_TRUE(falls_silent());
    session_.emplace(ports_.base(), ++sessions_, 4);  // another one
    // The view asks only a session that it has seen paused to go on. The one before never was.
    EXPECT_TRUE(screen_->press_until("p", [this] { return session_->count(OrderKind::kResume) > 0; }));
    EXPECT_TRUE(handled());
    EXPECT_FALSE(alarmed(end()));
    begin();
    ASSERT_TRUE(hears());
    ASSERT_TRUE(falls_silent());
    const Image silent = end();
    EXPECT_TRUE(alarmed(silent));
    expect_fixture_at_its_place(silent, 1);  // what was known last stays, and its age stands beside it
}

TEST_F(ExperimenterView, EveryKeyAsksTheSession) {
    begin();
    ASSERT_TRUE(hears());
    ASSERT_TRUE(screen_->type("8"));
    ASSERT_TRUE(asked(OrderKind::kNetwork));
    EXPECT_EQ(session_->last(OrderKind::kNetwork)->network.view(), "leo");
    ASSERT_TRUE(screen_->press("Right"));
    ASSERT_TRUE(asked(OrderKind::kDelay));
    EXPECT_TRUE(
        wait_until([&] { return std::abs(session_->last(OrderKind::kDelay)->value - 0.023) < 1e-9; }));
    ASSERT_TRUE(screen_->type("p"));
    EXPECT_TRUE(asked(OrderKind::kPause));
    // A view that has not yet seen the pause asks for it again.
    EXPECT_TRUE(screen_->press_until("p", [this] { return session_->count(OrderKind::kResume) > 0; }));
    EXPECT_TRUE(handled());
    EXPECT_EQ(session_->last(OrderKind::kRepeat)->trial, 4U);
    const int excluded = session_->count(OrderKind::kExclude);
    ASSERT_TRUE(screen_->type("xnxy"));
    EXPECT_TRUE(asked(OrderKind::kExclude, excluded + 5));
    ASSERT_TRUE(screen_->type("e"));
    EXPECT_TRUE(asked(OrderKind::kEndTrial));
    ASSERT_TRUE(screen_->type("4s"));
    ASSERT_TRUE(asked(OrderKind::kStart));
    EXPECT_EQ(session_->last(OrderKind::kStart)->modality, Modality::kVF);
    // The one that was answered with No was never sent: its key came long before that of the start.
    EXPECT_EQ(session_->count(OrderKind::kExclude), excluded + 5);
    EXPECT_FALSE(alarmed(end()));
}

TEST_F(ExperimenterView, ButtonsAndSliderAskTheSession) {
    begin();
    ASSERT_TRUE(hears());
    click_control(kSliderRow, 0, 1);
    ASSERT_TRUE(asked(OrderKind::kDelay));
    EXPECT_NEAR(session_->last(OrderKind::kDelay)->value, 0.25, 0.02);
    click_control(kNetworkRow + 1, 2, kNetworksPerRow);
    ASSERT_TRUE(asked(OrderKind::kNetwork));
    EXPECT_EQ(session_->last(OrderKind::kNetwork)->network.view(), "geo");
    click_control(kModalityRow, 1, 4);
    click_control(kTrialRow, 0, 3);
    ASSERT_TRUE(asked(OrderKind::kStart));
    EXPECT_EQ(session_->last(OrderKind::kStart)->modality, Modality::kCF);
    const int excluded = session_->count(OrderKind::kExclude);
    click_control(kAfterRow, 1, 3);  // Exclude, which asks
    EXPECT_EQ(session_->count(OrderKind::kExclude), excluded);
    const Rect question{190, 258, 420, 84};
    const Rect yes = control_cell(question, 1, 1, 0, 2);
    ASSERT_TRUE(screen_->click(static_cast<int>(yes.x + 20), static_cast<int>(yes.y + 10)));
    EXPECT_TRUE(asked(OrderKind::kExclude, excluded + 5));
}

TEST_F(ExperimenterView, SaysThatTheSessionDoesNotAnswer) {
    begin();
    ASSERT_TRUE(hears());
    session_->obey(false);
    session_->fail(
        "drive 3 (acting hand, index, cable 2): EMCY 0x2310 (over-current); remove the cause, then start "
        "again");
    ASSERT_TRUE(screen_->type("p"));
    // More than one: a slow view repeats it more rarely than each 50 ms. The device's words have come before.
    ASSERT_TRUE(asked(OrderKind::kPause, 2));
    wall_sleep(kOrderPatience);  // the view reads the same clock, so a slow view has waited as long
    EXPECT_LE(session_->count(OrderKind::kPause), 41);
    const Image image = end();
    EXPECT_TRUE(alarmed(image));
    // The device's words, black on red, over the top of the cut-away view and no more.
    const Rect side{0, kBannerHeight, experimenter_layout(800, 600, 1).readings.x, 600 - kBannerHeight};
    EXPECT_GT(count_pixels(image, {side.x, side.y, side.width, 10}, kVermillion), 5 * side.width);
    EXPECT_EQ(count_pixels(image, {side.x, side.y + side.height / 2, side.width, 10}, kVermillion), 0);
}

TEST_F(ExperimenterView, ListsEveryKey) {
    begin();
    ASSERT_TRUE(hears());
    ASSERT_TRUE(screen_->type("?"));
    ASSERT_TRUE(handled());
    const Image image = end();
    // The list stands in the middle, its keys in orange, one below the other.
    int lines = 0, before = 0;
    for (int y = 0; y < image.height; ++y) {
        const int now = count_pixels(image, {20, static_cast<double>(y), 150, 1}, kOrange);
        lines += now > 0 && before == 0;
        before = now;
    }
    EXPECT_GE(lines, 15);
}

TEST_F(ExperimenterView, FollowsTheWindowsSizeAndTheMonitorsScale) {
    begin();
    ASSERT_TRUE(hears());
    ASSERT_TRUE(screen_->resize(1100, 700));
    ASSERT_TRUE(handled());
    const Image resized = end();
    ASSERT_EQ(resized.width, 1100);
    ASSERT_EQ(resized.height, 700);
    expect_fixture_at_its_place(resized, 1);
    begin(4, {"--width", "600", "--height", "480", "--scale", "2"});
    ASSERT_TRUE(hears());
    const Image twice = end();
    ASSERT_EQ(twice.width, 1200);
    ASSERT_EQ(twice.height, 960);
    expect_fixture_at_its_place(twice, 2);
}

TEST_F(ExperimenterView, WithoutScreenOrPortItSaysWhatToDo) {
    const Folder folder;
    const auto run = [&](const std::string& name) {
        Child view(std::filesystem::path(THIMBLE_BIN_DIR) / "thimble-visual",
                   {"--role", "experimenter", "--base-port", std::to_string(ports_.base()), "--seconds", "1"},
                   folder / name);
        return view.wait(kPatience).value_or(-1);
    };
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    EXPECT_EQ(run("no_screen"), 2);
    EXPECT_NE(read_text(folder / "no_screen").find("no screen"), std::string::npos);
    NetworkSettings network;
    network.base_port = ports_.base();
    Sockets other(network);
    (void)other.inlet(Port::kExperimenterMonitor);
    EXPECT_EQ(run("no_port"), 3);
}

}  // namespace
}  // namespace thimble
