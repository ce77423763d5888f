// The test does what the screen says and nothing else: it hovers, clicks, drags, waits, pauses, ends, stops and releases.
#include <gtest/gtest.h>

#include "common/runtime/wall_clock.hpp"
#include "session/records/trial_table.hpp"
#include "tests/loopback/played_view.hpp"
#include "tests/loopback/workbench.hpp"
#include "tests/views/pushed_needle.hpp"
#include "tests/window/virtual_screen.hpp"

namespace thimble {
namespace {

class Newcomer : public OnAScreen {
  protected:
    void SetUp() override {
        OnAScreen::SetUp();
        if (IsSkipped()) return;
        play_.emplace(
            THIMBLE_BIN_DIR "/thimble",
            std::vector<std::string>{"play", a_slow_window(folder_), "--modality", "CF", "--delay-s", "0",
                                     "--base-port", std::to_string(ports_.base()), "--seconds", "300"},
            folder_ / "words");
    }

    bool sees(const std::function<bool(const Monitor&)>& such) {
        return wait_until([&] {
            view_.listen(wall_now());
            return such(view_.monitor());
        });
    }
    // On a machine that draws slowly a click can fall between two pictures: a person clicks again.
    bool does_until(const std::vector<std::string>& words, const std::function<bool(const Monitor&)>& such) {
        return wait_until([&] {
            view_.listen(wall_now());
            return such(view_.monitor()) || (hand(words), wall_sleep(std::chrono::milliseconds{300}), false);
        });
    }
    bool hand(const std::vector<std::string>& words) const { return screen_->hand(words); }

    Folder folder_;
    PortBlock ports_;
    std::optional<Child> play_;
    PlayedView view_{ports_.base()};
};

TEST_F(Newcomer, PushesTheNeedleInStopsAndGoesOnByTheScreenAlone) {
    ASSERT_TRUE(screen_->wait_for_window("Thimble")) << read_text(folder_ / "words");
    const auto running = [](const Monitor& m) { return m.state == NodeState::kRunning; };
    const auto idle = [](const Monitor& m) { return m.state == NodeState::kIdle; };
    ASSERT_TRUE(sees(running)) << read_text(folder_ / "words");
    // "Click in this picture. Then move the mouse down": pressed, and dragged.
    ASSERT_TRUE(hand({"mousemove", "300", "500", "sleep", "0.2", "mousedown", "1"}));
    EXPECT_TRUE(wait_until([&] {
        static_cast<void>(hand({"mousemove_relative", "0", "15"}));
        view_.listen(wall_now());
        return view_.monitor().phase == TissuePhase::kPenetrated;
    }));
    ASSERT_TRUE(hand({"mouseup", "1", "key", "Escape"}));
    // Pause, then End: the panel is still there to choose what comes next.
    ASSERT_TRUE(hand({"type", "p"}));
    EXPECT_TRUE(sees([](const Monitor& m) { return m.paused; }));
    ASSERT_TRUE(hand({"type", "e"}));
    EXPECT_TRUE(sees(idle));
    const std::vector<std::string> click{"sleep", "0.2", "mousedown", "1", "sleep", "0.1", "mouseup", "1"};
    const auto click_at = [&](const char* x, const char* y) {
        // A slow picture may see a click where the pointer was before, and hold the pointer.
        std::vector<std::string> words{"key", "Escape", "mousemove", x, y};
        words.insert(words.end(), click.begin(), click.end());
        return words;
    };
    EXPECT_TRUE(does_until(click_at("1100", "68"), running));
    // STOP, at the lower right. A click on it afterwards releases nothing; a press of a second does.
    EXPECT_TRUE(does_until(click_at("1100", "770"), idle));
    wall_sleep(std::chrono::milliseconds{800});
    ASSERT_TRUE(hand({"mousedown", "1", "sleep", "0.2", "mouseup", "1", "sleep", "0.4"}));
    ASSERT_TRUE(hand({"type", "1"}));
    wall_sleep(std::chrono::milliseconds{400});
    view_.listen(wall_now());
    EXPECT_TRUE(idle(view_.monitor())) << "still stopped";
    EXPECT_TRUE(wait_until([&] {
        static_cast<void>(
            hand({"mousedown", "1", "sleep", "2.5", "mouseup", "1", "sleep", "0.8", "type", "1"}));
        view_.listen(wall_now());
        return running(view_.monitor());
    })) << read_text(folder_ / "words");
    EXPECT_TRUE(screen_->press_until("F10", [&] { return play_->poll().has_value(); }));
    EXPECT_EQ(play_->wait(kPatience), 0) << read_text(folder_ / "words");
}

}  // namespace
}  // namespace thimble
