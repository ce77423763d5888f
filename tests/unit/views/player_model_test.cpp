#include "visual_node/views/player_model.hpp"

#include <set>

#include <gtest/gtest.h>

#include "tests/unit/views/played_session.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

struct PlayerBench {
    PlayedViewSession session;
    PlayerModel model{9, session.channels()};
    SessionTime now = at(milliseconds{100});

    void pass() {
        now += milliseconds{4};
        session.say(now);
        model.update(now);
    }
    std::string hint() {
        pass();
        return model.hint(now);
    }
    std::vector<HeardOrder> press(Command command) {
        model.press(now, command);
        return session.heard(now);
    }
};

TEST(PlayerModel, AModalityStartsAtOnceAndSpaceStartsItAgain) {
    PlayerBench bench;
    bench.pass();
    const auto started = bench.press(Command::kVF);
    ASSERT_EQ(started.size(), 1U);
    EXPECT_EQ(started[0].order.kind, OrderKind::kStart);
    EXPECT_EQ(started[0].order.modality, Modality::kVF);
    EXPECT_EQ(bench.model.modality(), Modality::kVF);
    EXPECT_EQ(bench.press(Command::kStart)[0].order.modality, Modality::kVF);
    EXPECT_EQ(bench.press(Command::kNetwork2)[0].order.network.view(), "paper50");
    EXPECT_EQ(bench.press(Command::kPause)[0].order.kind, OrderKind::kPause);
    EXPECT_EQ(bench.press(Command::kEndTrial)[0].order.kind, OrderKind::kEndTrial);
    EXPECT_TRUE(bench.press(Command::kExclude).empty());
}

TEST(PlayerModel, HintsFollowTheTrial) {
    PlayerBench bench;
    std::set<std::string> hints;
    hints.insert(bench.hint());
    Monitor& monitor = bench.session.monitor;
    monitor.state = NodeState::kRunning;
    monitor.position_fixture_m = 0.12;
    hints.insert(bench.hint());
    monitor.phase = TissuePhase::kContact;
    hints.insert(bench.hint());
    monitor.phase = TissuePhase::kPenetrated;
    hints.insert(bench.hint());
    monitor.position_needle_m = 0.121;
    hints.insert(bench.hint());
    monitor.network_delay_s = 0.05;
    EXPECT_NE(bench.hint().find("does it shake"), std::string::npos);
    hints.insert(bench.hint());
    monitor.modality = Modality::kVF;
    EXPECT_EQ(bench.hint().find("does it shake"), std::string::npos);
    monitor.beeped = true;
    hints.insert(bench.hint());
    monitor.needle_held = true;
    hints.insert(bench.hint());
    EXPECT_EQ(hints.size(), 8U);
}

TEST(PlayerModel, TellsWhatToExpectOfEachModality) {
    for (const Modality modality : kModalities) {
        EXPECT_GT(std::string_view(key_of(player_keys(), command_of(modality)).help).size(), 30U);
    }
}

}  // namespace
}  // namespace thimble
