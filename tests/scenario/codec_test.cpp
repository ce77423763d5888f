// Haptic codecs in whole virtual sessions: packets, penetration, loss.
#include <gtest/gtest.h>

#include "session/records/metrics.hpp"
#include "session/virtual/wire_use.hpp"
#include "tests/scenario/rig.hpp"
#include "tests/scenario/same_records.hpp"
#include "tests/scenario/trials.hpp"

namespace thimble::test {
namespace {

SystemSettings coded_by(HapticCodec codec) {
    CodecSettings keys;
    keys.command = keys.force = codec;
    return with_codec(paper(), keys);
}

double packets(const CountedTrial& trial) {
    double sum = 0;
    for (const FlowUse& flow : trial.wire) sum += flow.packets_per_s;
    return sum;
}

struct Sums {
    double packets = 0, mean_m = 0, max_m = 0, round_trip_s = 0;
};

// Single trials differ by more: the virtual hand decides a little sooner or later.
Sums four_subjects(const SystemSettings& settings, double delay_s) {
    Sums sums;
    for (std::uint32_t subject = 1; subject <= 4; ++subject) {
        const CountedTrial trial =
            run_counted_trial(settings, trial_of(Modality::kCF, from_seconds(delay_s), subject));
        const TrialMetrics metrics = measure(trial.record);
        EXPECT_TRUE(metrics.beeped);
        sums.packets += packets(trial);
        sums.mean_m += metrics.penetration_mean_m;
        sums.max_m += metrics.penetration_max_m;
        sums.round_trip_s += trial.record.round_trip_s;
    }
    return sums;
}

TEST(Codec, SavesNineOfTenPacketsAndTheNeedleGoesAsDeep) {
    for (const double delay_s : {0.0, 0.2}) {
        const Sums plain = four_subjects(paper(), delay_s);
        const Sums coded = four_subjects(coded_by(HapticCodec::kDeadbandLinear), delay_s);
        EXPECT_NEAR(plain.packets, 4 * 4000, 40);
        EXPECT_LT(coded.packets, 0.1 * plain.packets) << delay_s;
        EXPECT_NEAR(coded.max_m / plain.max_m, 1, 0.05) << delay_s;
        EXPECT_NEAR(coded.mean_m / plain.mean_m, 1, 0.05) << delay_s;
        EXPECT_NEAR(coded.round_trip_s, plain.round_trip_s, 4e-3) << delay_s;
    }
}

TEST(Codec, CountsHeadersAndSeals) {
    const CountedTrial plain = run_counted_trial(paper(), trial_of(Modality::kVF));
    EXPECT_EQ(haptic_packet_bytes(0, false), 104U + 64 + 28);
    EXPECT_NEAR(plain.wire[1].bytes_per_s / plain.wire[1].packets_per_s, 144 + 64 + 28, 1e-6);
}

TEST(Codec, EveryCodecHasTheSameBitsAgain) {
    for (const HapticCodec codec : {HapticCodec::kDeadband, HapticCodec::kEveryNth}) {
        const TrialConditions conditions = trial_of(Modality::kHF, std::chrono::milliseconds(10));
        const CountedTrial one = run_counted_trial(coded_by(codec), conditions);
        const CountedTrial other = run_counted_trial(coded_by(codec), conditions);
        EXPECT_TRUE(same_samples(one.record, other.record));
        EXPECT_EQ(packets(one), packets(other));
        EXPECT_EQ(one.record.reason, EndReason::kCompleted);
    }
}

// Of ten packets one is lost, and some overtake others: nothing falls silent, and only netem counts losses.
TEST(Codec, ALostPacketIsFollowedByAnotherBeforeAnyOutputIsStale) {
    SystemSettings settings = coded_by(HapticCodec::kDeadbandLinear);
    for (LinkSettings* link : {&settings.netem.needle, &settings.netem.force}) {
        link->loss = LossSettings::independent(0.1);
        link->in_order = false;
        link->jitter = {JitterShape::kUniform, std::chrono::milliseconds(3)};
        link->delay = std::chrono::milliseconds(10);
    }
    VirtualSession session(settings);
    const TrialRecord& record = session.run(trial_of(Modality::kCF, std::chrono::milliseconds(10)));
    EXPECT_EQ(record.reason, EndReason::kCompleted);
    EXPECT_EQ(session.slave().counters().of(Refusal::kSecondSender), 0U);
    EXPECT_GT(session.netem().relays()[0].model.counters().lost, 0U);
    double last_s = -1;
    for (const TrajectorySample& sample : record.samples) {
        ASSERT_GT(sample.time_s, last_s);
        last_s = sample.time_s;
    }
}

}  // namespace
}  // namespace thimble::test
