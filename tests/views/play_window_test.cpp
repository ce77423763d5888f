// `thimble play` as a person meets it: a window, a mouse, keys, and its pictures afterwards.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/runtime/wall_clock.hpp"
#include "session/records/trajectory_file.hpp"
#include "session/records/trial_table.hpp"
#include "session/render/render.hpp"
#include "tests/loopback/played_view.hpp"
#include "tests/loopback/programs.hpp"
#include "tests/loopback/workbench.hpp"
#include "tests/views/pushed_needle.hpp"
#include "tests/window/virtual_screen.hpp"
#include "visual_node/window/image.hpp"
#include "visual_node/window/picture.hpp"

namespace thimble {
namespace {

constexpr const char* kThimble = THIMBLE_BIN_DIR "/thimble";

class PlayInAWindow : public OnAScreen {
  protected:
    // Keys and the scrub bar of a replay, watched from the experimenter's ports.
    void seek_in_a_replay(const std::filesystem::path& out) {
        Child replay(kThimble,
                     {"play", "--replay", out.string(), "--speed", "0.1", "--base-port",
                      std::to_string(ports_.base()), "--seconds", "300"},
                     folder_ / "replay");
        PlayedView view(ports_.base());
        const auto shows = [&](const std::function<bool(const Monitor&)>& such) {
            return wait_until([&] {
                view.listen(wall_now());
                return view.replay().duration_s > 0 && view.running() && such(view.monitor());
            });
        };
        ASSERT_TRUE(shows([](const Monitor&) { return true; })) << read_text(folder_ / "replay");
        ASSERT_TRUE(screen_->wait_for_window("Thimble")) << read_text(folder_ / "replay");
        const double length_s = view.replay().duration_s;
        const auto at = [](double time_s) {
            return [time_s](const Monitor& m) { return m.paused && std::abs(m.time_s - time_s) < 1e-9; };
        };
        // A frame on: it stands still. The window may not listen to keys yet. Without a window manager it lies at the screen's
        // corner, and keys are for the window that the pointer moves in.
        bool aside = false;
        EXPECT_TRUE(wait_until([&] {
            aside = !aside;
            screen_->hand({"mousemove", "1100", aside ? "500" : "502", "key", "period"});
            view.listen(wall_now());
            return view.monitor().paused;
        }));
        ASSERT_TRUE(screen_->press("End"));
        EXPECT_TRUE(shows(at(length_s)));
        ASSERT_TRUE(screen_->press("Left"));
        EXPECT_TRUE(shows(at(length_s - 0.1)));
        ASSERT_TRUE(screen_->press("comma"));
        EXPECT_TRUE(shows(at(length_s - 0.1 - 1.0 / 60)));
        // The scrub bar lies below the hint; wherever it is, a click in its middle is about half of the trial.
        const auto half = [&] {
            view.listen(wall_now());
            return std::abs(view.monitor().time_s - length_s / 2) < 0.05 * length_s;
        };
        for (int y = 20; y < 100 && !half(); y += 10) {
            ASSERT_TRUE(screen_->hand({"mousemove", "1100", std::to_string(y), "sleep", "0.1", "mousedown",
                                       "1", "sleep", "0.1", "mouseup", "1", "sleep", "0.1"}));
        }
        EXPECT_TRUE(half());
        ASSERT_TRUE(screen_->press("5"));
        EXPECT_TRUE(shows([&](const Monitor&) { return view.replay().speed == 2; }));
        EXPECT_TRUE(screen_->press_until("F10", [&] { return replay.poll().has_value(); }));
        EXPECT_EQ(replay.wait(kPatience), 0) << read_text(folder_ / "replay");
    }

    Folder folder_;
    PortBlock ports_;
};

TEST_F(PlayInAWindow, AMouseMovesTheNeedleAKeyStartsAnotherTrialAndClosingEndsAll) {
    const auto out = folder_ / "played";
    Child play(kThimble,
               {"play", a_slow_window(folder_), "--modality", "HF", "--delay-s", "0", "--out", out.string(),
                "--base-port", std::to_string(ports_.base()), "--seconds", "300"},
               folder_ / "words");
    ASSERT_TRUE(screen_->wait_for_window("Thimble")) << read_text(folder_ / "words");
    const auto first = out / "trajectories" / "trial01_HF_0ms.csv";
    ASSERT_TRUE(wait_until([&] { return std::filesystem::exists(first); })) << read_text(folder_ / "words");
    ASSERT_TRUE(screen_->click(250, 450));
    EXPECT_TRUE(move_until(*screen_, 12, [&] { return newest_needle_m(first) > 0.005; }))
        << read_text(folder_ / "words");
    ASSERT_TRUE(screen_->press("Escape"));
    wall_sleep(std::chrono::milliseconds{300});
    ASSERT_TRUE(screen_->type("4"));
    const auto second = out / "trajectories" / "trial02_VF_0ms.csv";
    EXPECT_TRUE(wait_until([&] { return std::filesystem::exists(second); })) << read_text(folder_ / "words");
    EXPECT_TRUE(screen_->press_until("F10", [&] { return play.poll().has_value(); }));
    EXPECT_EQ(play.wait(kPatience), 0) << read_text(folder_ / "words");

    const auto rows = read_trial_table(out / "trials.csv");
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_EQ(rows[0].conditions.modality, Modality::kHF);
    EXPECT_EQ(rows[1].conditions.modality, Modality::kVF);
    EXPECT_EQ(rows[1].reason, EndReason::kInterrupted);

    seek_in_a_replay(out);

    // Its first trial again, as pictures.
    const auto frames = folder_ / "frames";
    Child video(kThimble,
                {"play", "--replay", out.string(), "--frames", frames.string(), "--frames-per-s", "5"},
                folder_ / "render");
    ASSERT_EQ(video.wait(4 * kPatience), 0) << read_text(folder_ / "render");
    const Trajectory trajectory = read_trajectory(first);
    const std::size_t count = frame_count(trajectory.samples.back().time_s, 5);
    EXPECT_TRUE(std::filesystem::exists(frame_file(frames, count - 1)));
    EXPECT_FALSE(std::filesystem::exists(frame_file(frames, count)));
    const Image early = read_png(frame_file(frames, 1)), late = read_png(frame_file(frames, count - 1));
    ASSERT_EQ(early.width, 800);
    EXPECT_NE(early.rgb, late.rgb);  // the needle has come nearer
    // Once more would overwrite them.
    Child again(kThimble, {"play", "--replay", out.string(), "--frames", frames.string()}, folder_ / "again");
    EXPECT_EQ(again.wait(kPatience), 2);
    EXPECT_THAT(read_text(folder_ / "again"), testing::HasSubstr("--overwrite"));
}

// In the place of ffmpeg stand scripts: one writes down its words, one fails.
TEST_F(PlayInAWindow, AVideoIsMadeByTheFfmpegInThePath) {
    const auto session = folder_.write("session.toml",
                                       "[session]\nmodalities = ['CF']\ndelays_s = [0.0]\n[trial]\n"
                                       "contact_hold_s = 0.1\n");
    const std::string out = folder_ / "out", video = folder_ / "trial.mp4";
    const Outcome run = run_thimble({"run", session, "--clock", "virtual", "--out", out});
    ASSERT_EQ(run.code, 0) << run.words;
    std::filesystem::create_directory(folder_ / "bin");
    const auto film = [&](const std::string& ffmpeg) {
        replace_program(folder_ / "bin/ffmpeg", ffmpeg);
        return run_to_end("/usr/bin/env",
                          {"PATH=" + (folder_ / "bin").string() + ":/usr/bin:/bin", kThimble, "play",
                           "--replay", out, "--video", video, "--frames-per-s", "5", "--overwrite"});
    };
    const Outcome made = film("printf '%s\\n' \"$@\" >'" + (folder_ / "told").string() + "'");
    EXPECT_EQ(made.code, 0) << made.words;
    const std::string told = read_text(folder_ / "told");
    for (const std::string& part :
         {std::string("-framerate\n5\n"), std::string("frame_%06d.png\n"), video + "\n"})
        EXPECT_THAT(told, testing::HasSubstr(part));
    const Outcome failed = film("echo there is no such codec; exit 1");
    EXPECT_EQ(failed.code, 1) << failed.words;
    EXPECT_THAT(failed.words, testing::HasSubstr("ffmpeg made no " + video + ": there is no such codec"));
}

TEST_F(PlayInAWindow, AScreenThatGoesAwayEndsThePlay) {
    const auto out = folder_ / "out";
    Child play(kThimble,
               {"play", a_slow_window(folder_), "--delay-s", "0", "--out", out.string(), "--base-port",
                std::to_string(ports_.base()), "--seconds", "300"},
               folder_ / "words");
    ASSERT_TRUE(wait_until([&] { return std::filesystem::exists(out / "trajectories"); }))
        << read_text(folder_ / "words");
    screen_.reset();  // the panel may not have its keys yet
    EXPECT_EQ(play.wait(kPatience), 0) << read_text(folder_ / "words");
}

TEST(PlayWithoutAScreen, IsRefusedWithTheReason) {
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    const Folder folder;
    const PortBlock ports;
    Child play(kThimble, {"play", "--base-port", std::to_string(ports.base())}, folder / "words");
    EXPECT_EQ(play.wait(kPatience), 2);
    EXPECT_THAT(read_text(folder / "words"), testing::HasSubstr("screen"));
    EXPECT_THAT(read_text(folder / "words"), testing::HasSubstr("thimble play --browser"));
}

}  // namespace
}  // namespace thimble
