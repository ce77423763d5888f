// The master's logic without channels and devices: which force acts, and when.
#include "master/master_node.hpp"

#include <string>

#include <gtest/gtest.h>

#include "common/control/built_in_controllers.hpp"
#include "common/error.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

// A trial in HF that began at 1 s, of a network that takes 50 ms there and back.
class MasterInTrial : public testing::Test {
  protected:
    MasterInTrial() { node.start_trial(begin, Modality::kHF, milliseconds{50}); }
    SessionTime after(int ms) const { return begin + milliseconds{ms}; }
    // The answer to the sample at `made_ms`.
    std::optional<double> take(int ms, int made_ms, bool held = false) {
        const ForceFeedback feedback{.force_total_N = -4, .echo_time = after(made_ms), .needle_held = held};
        return node.take(after(ms), feedback);
    }

    SessionTime begin = at(std::chrono::seconds{1});
    MasterNode node{MasterSettings{}};
};

TEST_F(MasterInTrial, AForceFadesWhenItsInputFallsSilent) {
    EXPECT_EQ(take(60, 10), 4);
    EXPECT_EQ(node.fade(after(159)), std::nullopt);
    EXPECT_FALSE(node.stale(after(159)));
    EXPECT_TRUE(node.stale(after(160)));
    EXPECT_DOUBLE_EQ(node.fade(after(170)).value(), 2) << "half of the ramp of 20 ms";
    EXPECT_EQ(node.fade(after(180)), 0);
    EXPECT_EQ(take(181, 140), 4);
    EXPECT_EQ(take(182, 141, true), 0) << "a held needle";
}

// The network may take 50 ms, and the policy 100 ms more.
TEST_F(MasterInTrial, AForceThatIsTooOldCountsAsNone) {
    EXPECT_EQ(take(149, 0), 4);
    EXPECT_EQ(take(151, 1), std::nullopt);
    EXPECT_TRUE(node.stale(after(151)));
    node.network_changed(milliseconds{60});
    EXPECT_EQ(take(152, 2), 4);
}

// Else a session of a longer delay would have no force, and HF would not oscillate in it.
TEST_F(MasterInTrial, TheOldestForceIsNeverYoungerThanTheNetworksDelay) {
    const auto counts = [&](Duration oldest, int age_ms) {
        MasterSettings settings;
        settings.oldest_force = oldest;
        MasterNode other(settings);
        other.start_trial(begin, Modality::kHF, milliseconds{50});
        return other.take(after(age_ms), ForceFeedback{.force_total_N = -4, .echo_time = begin}).has_value();
    };
    for (const milliseconds oldest : {milliseconds{10}, milliseconds{60}}) {
        const int limit_ms = oldest == milliseconds{10} ? 150 : 160;
        EXPECT_TRUE(counts(oldest, limit_ms - 1)) << limit_ms;
        EXPECT_FALSE(counts(oldest, limit_ms)) << limit_ms;
    }
}

TEST_F(MasterInTrial, AForceFadesWhileAllOthersComeTooLate) {
    EXPECT_EQ(take(60, 10), 4);
    EXPECT_EQ(take(165, 10), std::nullopt) << "5 ms older than counts";
    EXPECT_EQ(take(170, 15), std::nullopt);
    EXPECT_DOUBLE_EQ(node.fade(after(170)).value(), 2);
    EXPECT_EQ(take(180, 25), std::nullopt);
    EXPECT_EQ(node.fade(after(180)), 0);
}

TEST_F(MasterInTrial, AfterAPauseItsForceIsGoneUntilTheNextOne) {
    EXPECT_EQ(take(60, 10), 4);
    node.begin_tick(milliseconds{101});
    EXPECT_EQ(take(161, 110), std::nullopt) << "it has waited";
    EXPECT_EQ(node.fade(after(161)), 0);
    node.begin_tick(milliseconds{1});
    EXPECT_EQ(node.fade(after(162)), std::nullopt);
    EXPECT_EQ(take(162, 112), 4);
}

// Its force says how many forces it received, and which it was given last.
class CountingEnd {
  public:
    explicit CountingEnd(const thimble_controller_settings& /*settings*/) {}
    void start(double /*delay_s*/) {}
    void sample(const thimble_handle& /*handle*/, thimble_packet& /*out*/) {}
    void receive(const thimble_feedback& /*feedback*/) { ++received_; }
    void forget() {}
    double force_N(const thimble_feedback& newest) const {
        return received_ + newest.force_total_hand_N + newest.age_s;
    }

  private:
    int received_ = 0;
};

MasterSettings driven_by(const thimble_controller& table, HapticCodec force) {
    MasterSettings settings;
    settings.codec.force = force;
    settings.control.compensator = Compensator::kPlugin;
    settings.control.plugin.table = &table;
    return settings;
}

TEST(MasterNode, AForceAgesForItsControllerWhileNoneComes) {
    const thimble_controller table = with_memory<CountingEnd>(with_handle<CountingEnd>({}));
    MasterNode node(driven_by(table, HapticCodec::kNone));
    const SessionTime begin = at(std::chrono::seconds{1});
    node.start_trial(begin, Modality::kHF, milliseconds{50});
    EXPECT_EQ(node.force_at_sample_N(begin), 0) << "no force yet, and no age";
    node.take(begin + milliseconds{40}, ForceFeedback{.force_total_N = -1, .echo_time = begin});
    for (const int since_ms : {1, 30})
        EXPECT_NEAR(node.force_at_sample_N(begin + milliseconds{40 + since_ms}).value(),
                    1 + 1 + 0.04 + 1e-3 * since_ms, 1e-12);
}

TEST(MasterNode, APredictedForceReachesEachControllerAndIsNotReceived) {
    for (const std::uint32_t capabilities : {0U, std::uint32_t{THIMBLE_AT_ONCE}}) {
        thimble_controller table = with_memory<CountingEnd>(with_handle<CountingEnd>({}));
        table.capabilities = capabilities;
        MasterNode node(driven_by(table, HapticCodec::kDeadbandLinear));
        const SessionTime begin = at(std::chrono::seconds{1});
        node.start_trial(begin, Modality::kHF, milliseconds{50});
        for (const int made_ms : {0, 10}) {
            const ForceFeedback feedback{.force_total_N = -1 - 0.01 * made_ms,
                                         .echo_time = begin + milliseconds{made_ms}};
            node.take(feedback.echo_time + milliseconds{40}, feedback);
        }
        for (const int since_ms : {1, 5})
            EXPECT_NEAR(node.force_at_sample_N(begin + milliseconds{50 + since_ms}).value(),
                        2 + 1.1 + 0.01 * since_ms + 0.04 + 1e-3 * since_ms, 1e-12);
    }
}

TEST(MasterSettings, RefusesASamplePeriodThatLetsEachForceGoStale) {
    const auto stale_after = [](const std::string& keys) {
        const ConfigFile file = ConfigFile::parse("[master]\n" + keys, "test");
        return read_master_settings(file).stale.after;
    };
    EXPECT_EQ(stale_after("sample_period_s = 0.09"), Duration{milliseconds{100}});
    for (const char* keys : {"sample_period_s = 0.1", "stale_after_s = 0.001"})
        EXPECT_THROW(stale_after(keys), Error) << keys;
}

TEST_F(MasterInTrial, SamplesThatWereMissedAreSkipped) {
    EXPECT_TRUE(node.take_due(begin));
    EXPECT_FALSE(node.take_due(begin));
    EXPECT_EQ(node.next_sample(), after(1));
    EXPECT_TRUE(node.take_due(after(4)));
    EXPECT_EQ(node.samples_skipped(), 3U);
    EXPECT_EQ(node.next_sample(), after(5));
    node.end_trial();
    EXPECT_EQ(node.next_sample(), kNever);
}

TEST_F(MasterInTrial, TheOperatorGetsTheNewestOfSkinAndEyes) {
    node.feel({.force_N = 0.5, .finger = Finger::kThumb});
    const Percept& both = node.see({.force_N = 9, .bar_N = 3});
    EXPECT_EQ(both.finger, Finger::kThumb);
    EXPECT_EQ(both.force_N, 0.5);
    EXPECT_EQ(both.bar_N, 3);
    EXPECT_EQ(node.feel({.force_N = 0.7}).bar_N, 3);
}

}  // namespace
}  // namespace thimble
