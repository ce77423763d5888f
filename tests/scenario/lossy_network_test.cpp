// A network that jitters and loses, and one that stops.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "session/records/metrics.hpp"
#include "tests/scenario/rig.hpp"
#include "tests/scenario/trials.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

SystemSettings lossy() {
    SystemSettings settings = paper_with_delays(milliseconds{5}, kPaperDelay);
    settings.netem.needle.jitter = {JitterShape::kUniform, milliseconds{3}};
    settings.netem.needle.loss = LossSettings::independent(0.02);
    settings.netem.needle.in_order = false;
    settings.netem.force.jitter = {JitterShape::kNormal, milliseconds{10}};
    settings.netem.force.loss = LossSettings::independent(0.05);
    settings.netem.force.in_order = false;
    return settings;
}

TEST(LossyNetwork, TheTrialCompletesAndEveryPacketIsAccountedFor) {
    for (const Modality modality : {Modality::kHF, Modality::kCF, Modality::kVF}) {
        Rig rig(lossy());
        const TrialRecord& record = rig.run(trial_of(modality, kPaperDelay));
        EXPECT_EQ(record.reason, EndReason::kCompleted) << to_string(modality);
        EXPECT_EQ(measure(record).oscillates, modality == Modality::kHF);
        std::uint64_t delivered = 0;
        for (const Relay& relay : rig.netem().relays()) {
            const LinkCounters& link = relay.model.counters();
            const double loss = static_cast<double>(link.lost) / static_cast<double>(link.pushed);
            EXPECT_NEAR(loss, relay.model.settings().loss.probability, 0.02);
            EXPECT_EQ(link.pushed, link.lost + link.delivered + relay.model.in_flight());
            EXPECT_EQ(link.overflowed + link.oversized, 0U);
            delivered += link.delivered;
        }
        EXPECT_EQ(rig.netem().relays()[0].model.counters().pushed, rig.master().samples());
        // A packet that overtakes others makes them outdated. Every packet is used or counted.
        const FlowCounters counters = rig.counters();
        EXPECT_GT(counters.of(Refusal::kOutdated), delivered / 4);
        EXPECT_EQ(counters.refused_total(),
                  counters.of(Refusal::kOutdated) + counters.of(Refusal::kWrongTrial));
    }
}

// In order, jitter alone makes nothing outdated.
TEST(LossyNetwork, InOrderJitterRefusesNothingWhileTheTrialRuns) {
    SystemSettings settings = lossy();
    settings.netem.needle.in_order = settings.netem.force.in_order = true;
    Rig rig(settings);
    EXPECT_EQ(rig.run(trial_of(Modality::kCF, kPaperDelay)).reason, EndReason::kCompleted);
    EXPECT_EQ(rig.counters().of(Refusal::kOutdated), 0U);
    EXPECT_EQ(rig.counters().of(Refusal::kDuplicate), 0U);
}

TEST(LossyNetwork, ANetworkThatDeliversNothingEndsTheTrialWithinASecond) {
    for (const bool needle : {true, false}) {
        SystemSettings settings = paper();
        (needle ? settings.netem.needle : settings.netem.force).loss = LossSettings::independent(1);
        Rig rig(settings);
        const TrialRecord& record = rig.run(trial_of(Modality::kHF));
        EXPECT_EQ(record.reason, EndReason::kPeerLost);
        EXPECT_LT(rig.now(), SessionTime{seconds{1}});
        EXPECT_EQ(rig.handle().force_hand_N(), 0);
        EXPECT_TRUE(needle ? record.samples.empty() : !record.samples.empty());
    }
}

struct Outage {
    const char* name;
    std::vector<Wire> wires;
};

class Outages : public testing::TestWithParam<Outage> {};

// In the middle of the hold, with the fixture pushing against the hand.
TEST_P(Outages, LetGoOfTheHandAndEndTheTrialWithinASecond) {
    bool cut_now = false;
    Rig rig(paper(), tap_on<Scissors>(GetParam().wires, cut_now));
    rig.start(trial_of(Modality::kHF));
    ASSERT_TRUE(rig.run_until_contact(2));
    ASSERT_GT(rig.handle().force_hand_N(), 0.5);
    const SessionTime cut = rig.now();
    cut_now = true;
    rig.run_until(cut + paper().master.stale.after + paper().master.stale.ramp + milliseconds{2});
    EXPECT_EQ(rig.handle().force_hand_N(), 0);
    const TrialRecord& record = rig.finish();
    EXPECT_EQ(record.reason, EndReason::kPeerLost);
    EXPECT_LT(rig.now() - cut, seconds{1});
    EXPECT_EQ(rig.handle().force_hand_N(), 0);
    EXPECT_EQ(rig.handle().refused_forces(), 0U);
    // Answers about a needle that is only held are no samples.
    for (std::size_t i = 1; i < record.samples.size(); ++i) {
        ASSERT_GT(record.samples[i].time_s, record.samples[i - 1].time_s);
    }
}

INSTANTIATE_TEST_SUITE_P(
    MidTrial, Outages,
    testing::Values(Outage{"Force", {Wire::kForceMaster, Wire::kForceCutaneous, Wire::kForceVisual}},
                    Outage{"ForceToTheHandle", {Wire::kForceMaster}}, Outage{"Needle", {Wire::kNeedle}},
                    Outage{"Everything",
                           {Wire::kNeedle, Wire::kForceMaster, Wire::kForceCutaneous, Wire::kForceVisual}}),
    [](const auto& test) { return std::string(test.param.name); });

// A session that falls silent must not leave a hand under force.
TEST(LossyNetwork, ASilentSessionStopsTheNodes) {
    bool cut_now = false;
    Rig rig(paper(), tap_on<Scissors>({Wire::kOrders}, cut_now));
    rig.start(trial_of(Modality::kHF));
    ASSERT_TRUE(rig.run_until_contact(1));
    cut_now = true;
    const SessionTime cut = rig.now();
    rig.run_until(cut + seconds{1});
    EXPECT_EQ(rig.handle().force_hand_N(), 0);
    for (const NodeProcess* node : rig.nodes()) {
        EXPECT_EQ(node->state(), NodeState::kFailed) << to_string(node->role());
    }
    EXPECT_EQ(rig.finish().reason, EndReason::kPeerLost);
}

}  // namespace
}  // namespace thimble::test
