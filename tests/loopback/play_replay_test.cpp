// `thimble play --replay`: what was played is shown again, by the real programs.
#include <gtest/gtest.h>

#include "common/runtime/wall_clock.hpp"
#include "tests/loopback/played_hand.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

TEST(PlayReplay, ShowsWhatWasPlayed) {
    PlayedHand hand({"--modality", "CF", "--delay-s", "0"});
    ASSERT_TRUE(hand.play([&] { return hand.running(); })) << hand.words();
    hand.go_to(0.02);
    hand.play_for(std::chrono::milliseconds{1700});
    ASSERT_EQ(hand.quit(), 0) << hand.words();

    const Folder folder;
    const PortBlock ports;
    Child replay(built_programs() / "thimble",
                 {"play", "--replay", hand.out().string(), "--speed", "0.5", "--visual-command",
                  "thimble-visual", "--base-port", std::to_string(ports.base())},
                 folder / "words");
    PlayedView view(ports.base());
    const auto watch = [&](const std::function<bool()>& done) {
        return wait_until([&] {
                   view.listen(wall_now());
                   return done() || replay.poll();
               }) &&
               !replay.poll();
    };
    const auto say = [&](OrderKind kind, double value = 0) {
        Order order;
        order.kind = kind;
        order.value = value;
        view.order(wall_now(), order);
    };
    ASSERT_TRUE(watch([&] { return view.running() && view.monitor().time_s > 0.2; }))
        << read_text(folder / "words");
    EXPECT_EQ(view.monitor().modality, Modality::kCF);
    EXPECT_EQ(view.monitor().position_fixture_m, 0.035);
    say(OrderKind::kPause);
    ASSERT_TRUE(watch([&] { return view.monitor().paused; }));
    say(OrderKind::kSeek, 1.5);
    ASSERT_TRUE(watch([&] { return view.monitor().time_s == 1.5; }));
    EXPECT_GT(view.monitor().position_needle_m, 0.01);
    EXPECT_EQ(nodes_alive(ports.base()), std::vector<std::string>{"thimble-visual"});
    say(OrderKind::kQuit);
    EXPECT_EQ(replay.wait(kPatience).value_or(-1), 0) << read_text(folder / "words");
    EXPECT_TRUE(nodes_alive(ports.base()).empty());
}

TEST(PlayReplay, SaysWhichTrialThereIsNot) {
    const Folder folder;
    const PortBlock ports;
    const Outcome outcome =
        run_thimble({"play", "--replay", (folder / "nothing").string(), "--visual-command", "thimble-visual",
                     "--base-port", std::to_string(ports.base())});
    EXPECT_EQ(outcome.code, 5);
    EXPECT_NE(outcome.words.find("trials.csv"), std::string::npos) << outcome.words;
    EXPECT_EQ(run_thimble({"play", "--trial", "2"}).code, 2);
}

}  // namespace
}  // namespace thimble
