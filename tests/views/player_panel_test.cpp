// The player's panel over an empty scene, in this process.
#include "visual_node/views/player_panel.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "common/runtime/wall_clock.hpp"
#include "tests/unit/views/played_session.hpp"
#include "tests/views/fake_session.hpp"
#include "tests/views/pixels.hpp"
#include "tests/window/virtual_screen.hpp"
#include "visual_node/window/gui_layer.hpp"

namespace thimble {
namespace {

class PlayerWindow {
  public:
    PlayerWindow() : window_(settings()), gui_(window_) {}

    // At 10 frames per second of a clock of its own, so that a busy machine changes no picture; `talking`: the session sends.
    void run(double seconds, bool talking = true) {
        const SessionTime until = now_ + from_seconds(seconds);
        while (now_ < until) {
            const SessionTime now = now_ += std::chrono::milliseconds{100};
            if (talking) talk(now);
            window_.poll_events();
            panel_.tick(now);
            window_.begin_frame(kBlack);
            gui_.begin();
            panel_.draw(now, {window_, nullptr});
            gui_.end();
            image_ = window_.read_pixels();
            window_.end_frame();
        }
    }
    const Image& image() const { return image_; }
    static WindowSettings settings() {
        return {.title = "Thimble, panel under test", .vsync = false, .content_scale = 1};
    }

  private:
    void talk(SessionTime now) {
        if (begun_ == SessionTime{}) begun_ = now;
        for (; told_ms_ < to_seconds(now - begun_) * 1e3; told_ms_ += 4) {
            session_.monitor = demonstration(kDemonstrationContact_s + 1 + told_ms_ * 1e-3);
            session_.say(begun_ + from_seconds(told_ms_ * 1e-3));
            panel_.tick(now);  // as the window does between frames
        }
    }

    PlayedViewSession session_;
    PlayerPanel panel_{5, session_.channels()};
    GlWindow window_;
    GuiLayer gui_;
    Image image_;
    SessionTime now_ = wall_now(), begun_{};
    double told_ms_ = 0;
};

using PlayerPanelTest = OnAScreen;

TEST_F(PlayerPanelTest, ShowsTheLastSecondsAndNeverTheFixture) {
    PlayerWindow player;
    player.run(1.5);
    const Image& image = player.image();
    const Rect whole{0, 0, static_cast<double>(image.width), static_cast<double>(image.height)};
    const Rect panel = PlayerPanel::place(image.width, image.height, 1);
    EXPECT_GT(count_pixels(image, panel, kOrange), 100);  // the needle's curve
    EXPECT_EQ(count_pixels(image, whole, kReddishPurple), 0);
    EXPECT_GT(count_pixels(image, {0, 0, panel.x, whole.height}, kYellow), 100);  // the next step
    EXPECT_EQ(count_pixels(image, panel, kVermillion), 0);
    player.run(1, false);
    EXPECT_GT(count_pixels(player.image(), panel, kVermillion), 50);  // silence, in red
}

TEST_F(PlayerPanelTest, WithSocketsOfItsOwnItAsksARealSession) {
    const PortBlock ports;
    NetworkSettings network;
    network.base_port = ports.base();
    FakeSession session(ports.base(), 1, 4);
    const auto overlay = std::make_unique<PlayerOverlay>(5, network);
    GlWindow window(PlayerWindow::settings());
    GuiLayer gui(window);
    const auto frame = [&] {
        const SessionTime now = wall_now();
        window.poll_events();
        overlay->tick(now);
        window.begin_frame(kBlack);
        gui.begin();
        overlay->draw(now, {window, nullptr});
        gui.end();
        window.end_frame();
    };
    frame();
    ASSERT_TRUE(screen_->wait_for_window("panel under test"));
    ASSERT_TRUE(screen_->press("5"));
    EXPECT_TRUE(wait_until([&] {
        frame();
        const auto order = session.last(OrderKind::kNetwork);
        return order && order->network.view() == "ideal";
    }));
    ASSERT_TRUE(screen_->press("plus"));
    EXPECT_TRUE(wait_until([&] {
        frame();
        const auto delay = session.last(OrderKind::kDelay);
        return delay && delay->value > 0;
    }));
    ASSERT_TRUE(screen_->press("4"));
    EXPECT_TRUE(wait_until([&] {
        frame();
        const auto start = session.last(OrderKind::kStart);
        return start && start->modality == Modality::kVF;
    }));
    // The slider lies below the modalities; wherever its row is, a click in its middle asks for about half of 500 ms.
    const Rect panel = PlayerPanel::place(window.width(), window.height(), 1);
    const int x = static_cast<int>(panel.x + panel.width / 2);
    const auto half = [&] {
        const auto delay = session.last(OrderKind::kDelay);
        return delay && std::abs(delay->value - 0.25) < 0.03;
    };
    for (int y = 230; y < 330 && !half(); y += 8) {
        ASSERT_TRUE(screen_->hand({"mousemove", std::to_string(x), std::to_string(y), "mousedown", "1"}));
        for (int i = 0; i < 4; ++i) frame();
        ASSERT_TRUE(screen_->hand({"mouseup", "1"}));
        for (int i = 0; i < 4; ++i) frame();
        wall_sleep(std::chrono::milliseconds{50});
    }
    EXPECT_TRUE(half());
}

}  // namespace
}  // namespace thimble
