// A network that jitters and loses, and one that stops.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "common/random.hpp"
#include "session/records/metrics.hpp"
#include "tests/scenario/rig.hpp"
#include "tests/scenario/same_records.hpp"
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
    for (std::size_t i = 1; i < record.samples.size(); ++i)
        ASSERT_GT(record.samples[i].time_s, record.samples[i - 1].time_s);
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
    for (const NodeProcess* node : rig.nodes())
        EXPECT_EQ(node->state(), NodeState::kFailed) << to_string(node->role());
    EXPECT_EQ(rig.finish().reason, EndReason::kPeerLost);
}

// A network that duplicates, reorders, loses, truncates and flips bits on every wire, and nodes that come
// back as another program: a trial completes or ends cleanly, the record holds only numbers, and the counters
// say what happened.
// Probabilities, per datagram.
struct Malice {
    double duplicate = 0, reorder = 0, lose = 0, truncate = 0, flip = 0;
};

class HostileTap final : public Tap {
  public:
    HostileTap(Channel& end, const Malice& malice, std::uint32_t seed, std::uint32_t wire)
        : Tap(end), malice_(malice), random_({.study = seed, .trial = wire, .purpose = Purpose::kLinkLoss}) {}

    void send(Bytes datagram) override {
        std::vector<std::uint8_t> packet(datagram.begin(), datagram.end());
        if (chance(malice_.truncate)) packet.resize(random_.below(static_cast<std::uint32_t>(packet.size())));
        if (chance(malice_.flip)) flip(packet);
        if (chance(malice_.lose)) return;
        if (kept_.empty() && chance(malice_.reorder)) {
            kept_ = packet;  // leaves after the next one
            return;
        }
        Tap::send(packet);
        if (chance(malice_.duplicate)) Tap::send(packet);
        if (!kept_.empty()) Tap::send(kept_);
        kept_.clear();
    }

  private:
    bool chance(double probability) { return random_.uniform() < probability; }
    void flip(std::vector<std::uint8_t>& packet) {
        if (packet.empty()) return;
        const std::uint32_t byte = random_.below(static_cast<std::uint32_t>(packet.size()));
        packet[byte] = static_cast<std::uint8_t>(packet[byte] ^ (1U << random_.below(8)));
    }

    Malice malice_;
    RandomStream random_;
    std::vector<std::uint8_t> kept_;
};

MakeTap hostile(const Malice& malice, std::uint32_t seed) {
    return [malice, seed, wires = 0U](Wire, Channel& end) mutable -> std::unique_ptr<Tap> {
        return std::make_unique<HostileTap>(end, malice, seed, ++wires);
    };
}

bool only_numbers(const TrialRecord& record) {
    return std::all_of(record.samples.begin(), record.samples.end(), [](const TrajectorySample& s) {
        return std::isfinite(s.time_s) && std::isfinite(s.position_needle_m) &&
               std::isfinite(s.position_surface_m) && std::isfinite(s.force_tissue_N) &&
               std::isfinite(s.force_fixture_N) && std::isfinite(s.force_total_N) &&
               std::isfinite(s.contact_time_s);
    });
}

void expect_clean_end(Rig& rig, const TrialRecord& record) {
    EXPECT_TRUE(rig.session().finished());
    EXPECT_NE(record.reason, EndReason::kNone);
    EXPECT_TRUE(only_numbers(record));
    EXPECT_LT(rig.now(), SessionTime{seconds{70}});  // the trial's time-out and the nodes' last words
    EXPECT_EQ(rig.handle().refused_forces(), 0U);
}

TEST(HostileNetwork, DuplicatesAreCountedAndChangeNothing) {
    for (const Modality modality : {Modality::kHF, Modality::kVF}) {
        Rig quiet(paper());
        Rig rig(paper(), hostile({.duplicate = 0.3}, 1));
        const TrialRecord& record = rig.run(trial_of(modality));
        expect_clean_end(rig, record);
        EXPECT_EQ(record.reason, EndReason::kCompleted);
        EXPECT_TRUE(same_samples(record, quiet.run(trial_of(modality))));
        EXPECT_GT(rig.counters().of(Refusal::kDuplicate), 1000U);
    }
}

TEST(HostileNetwork, ReorderingLossAndTruncationAreSurvived) {
    for (std::uint32_t seed = 1; seed <= 3; ++seed) {
        Rig rig(paper_with_delays({}, kPaperDelay),
                hostile({.duplicate = 0.05, .reorder = 0.05, .lose = 0.05, .truncate = 0.05}, seed));
        const TrialRecord& record = rig.run(trial_of(Modality::kCF, kPaperDelay));
        expect_clean_end(rig, record);
        EXPECT_EQ(record.reason, EndReason::kCompleted);
        const FlowCounters counters = rig.counters();
        for (const Refusal refusal :
             {Refusal::kDuplicate, Refusal::kOutdated, Refusal::kMalformed, Refusal::kTooShort}) {
            EXPECT_GT(counters.of(refusal), 10U) << to_string(refusal);
        }
    }
}

// A flipped bit in a number is a wrong number (the checksum against that is UDP's); in a sequence or a stamp
// it may silence its flow. Forbidden: a NaN, a trial without end, a force that is not a number.
TEST(HostileNetwork, FlippedBitsEndATrialCleanlyAtWorst) {
    FlowCounters sum;
    std::size_t longest = 0;
    for (std::uint32_t seed = 1; seed <= 18; ++seed) {
        const auto modality = static_cast<Modality>(seed % 4);
        const double flip = std::array{2e-2, 1e-3, 5e-5}[seed % 3];
        Rig rig(paper(), hostile({.duplicate = 0.01, .reorder = 0.01, .truncate = 0.01, .flip = flip}, seed));
        const TrialRecord& record = rig.run(trial_of(modality));
        expect_clean_end(rig, record);
        sum.add(rig.counters());
        longest = std::max(longest, record.samples.size());
    }
    for (const Refusal refusal : {Refusal::kForeignFormat, Refusal::kMalformed, Refusal::kOutOfRange,
                                  Refusal::kSecondSender, Refusal::kDuplicate, Refusal::kWrongTrial}) {
        EXPECT_GT(sum.of(refusal), 0U) << to_string(refusal);
    }
    EXPECT_GT(longest, 5000U);  // some get into the thick of it
}

// A sequence or a stamp from far ahead, once admitted, makes everything after it old: the trial is lost, but
// no more.
TEST(HostileNetwork, OnePoisonedPacketCostsOneTrial) {
    class Poison final : public Tap {
      public:
        Poison(Channel& end, bool& poisoned) : Tap(end), poisoned_(&poisoned) {}
        void send(Bytes datagram) override {
            const Decoded decoded = decode(datagram);
            if (!*poisoned_ && decoded.message && decoded.message->header.sequence == 1000) {
                *poisoned_ = true;
                Message message = *decoded.message;
                message.header.sequence += 1U << 30;
                message.header.send_time += std::chrono::hours{1000};
                Tap::send(encoder_.encode(message));
            }
            Tap::send(datagram);
        }

      private:
        bool* poisoned_;
        Encoder encoder_;
    };
    for (const Wire wire : {Wire::kNeedle, Wire::kForceMaster, Wire::kForceVisual}) {
        bool poisoned = false;
        Rig rig(paper(), tap_on<Poison>({wire}, poisoned));
        EXPECT_EQ(rig.run(trial_of(Modality::kHF, {}, 1, 1)).reason, EndReason::kPeerLost);
        EXPECT_TRUE(poisoned);
        EXPECT_LT(rig.now(), SessionTime{seconds{2}});
        EXPECT_EQ(rig.handle().force_hand_N(), 0);
        EXPECT_GT(rig.counters().of(Refusal::kOutdated), 100U);
        EXPECT_EQ(rig.run(trial_of(Modality::kHF, {}, 1, 2)).reason, EndReason::kCompleted);
    }
}

TEST(HostileNetwork, ASecondMasterIsLockedOut) {
    class SecondMaster final : public Tap {
      public:
        explicit SecondMaster(Channel& end) : Tap(end), flow_(Role::kMaster, 666, {&end}) {}
        void send(Bytes datagram) override {
            Tap::send(datagram);
            NeedleCommand command;
            command.position_needle_m = command.position_needle_estimate_m = -1;
            flow_.send(SessionTime{seconds{1000}}, 1, command);
        }

      private:
        OutboundFlow flow_;
    };
    Rig quiet(paper());
    Rig rig(paper(), tap_on<SecondMaster>({Wire::kNeedle}));
    const TrialRecord& record = rig.run(trial_of(Modality::kHF));
    EXPECT_EQ(record.reason, EndReason::kCompleted);
    EXPECT_TRUE(same_samples(record, quiet.run(trial_of(Modality::kHF))));
    EXPECT_GT(rig.slave().counters().of(Refusal::kSecondSender), 1000U);
}

}  // namespace
}  // namespace thimble::test
