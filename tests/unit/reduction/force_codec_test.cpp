// Forces that are not sent: how wrong the handle's end may be, and what is always sent.
#include "common/reduction/force_codec.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace thimble {
namespace {

using std::chrono::milliseconds;

constexpr Duration kAnswerPeriod = milliseconds(1);

CodecSettings forces_by(HapticCodec codec) {
    CodecSettings settings;
    settings.force = codec;
    return settings;
}

SessionTime stamp_of(int sample) { return SessionTime{milliseconds(1000 + sample)}; }

ForceFeedback force(int sample, double force_N) {
    ForceFeedback feedback;
    feedback.echo_time = stamp_of(sample);
    feedback.force_total_N = force_N;
    return feedback;
}

std::vector<double> any_forces() {
    std::vector<double> forces;
    double now = 0, slope = 0;
    for (const int bend : *rc::gen::container<std::vector<int>>(8, rc::gen::inRange(-100, 100))) {
        slope = bend * 1e-3;
        const int samples = *rc::gen::inRange(1, 60);
        forces.reserve(forces.size() + static_cast<std::size_t>(samples));
        for (int i = 0; i < samples; ++i) {
            now = std::min(now + slope, 0.0);
            forces.push_back(now);
        }
    }
    return forces;
}

double width_N(const CodecSettings& settings, double sent_N) {
    if (!is_deadband(settings.force)) return settings.delta_force_N;
    return settings.weber_fraction * std::max(std::abs(sent_N), settings.force_floor_N);
}

// Without loss the handle is wrong by no more than the deadband of the last force sent.
RC_GTEST_PROP(ForceGate, BoundsTheErrorAtTheHandle, ()) {
    const CodecSettings settings = forces_by(
        *rc::gen::element(HapticCodec::kDeadband, HapticCodec::kDeadbandLinear, HapticCodec::kSendOnDelta));
    ForceGate gate(settings, kAnswerPeriod, true);
    ForceFill fill(settings, kAnswerPeriod);
    const std::vector<double> forces = any_forces();
    double sent_N = 0;
    for (int i = 0; i < static_cast<int>(forces.size()); ++i) {
        const double now_N = forces[static_cast<std::size_t>(i)];
        if (gate.due(stamp_of(i), force(i, now_N))) {
            sent_N = now_N;
            fill.heard(stamp_of(i + 50), force(i, now_N));
        }
        const double there_N = fill.predicts() ? fill.at(stamp_of(i + 50)).force_total_N : sent_N;
        RC_ASSERT(std::abs(there_N - now_N) <= width_N(settings, sent_N) + 1e-12);
    }
}

// A lost packet changes the slope at the handle, until two more have come.
RC_GTEST_PROP(ForceLine, ForgetsALostPacketAfterTwoMore, ()) {
    const std::vector<double> forces = any_forces();
    RC_PRE(forces.size() > 3);
    const int lost = *rc::gen::inRange(0, static_cast<int>(forces.size()) - 2);
    const CodecSettings settings = forces_by(HapticCodec::kDeadbandLinear);
    ForceLine sender(settings, kAnswerPeriod), receiver(settings, kAnswerPeriod);
    for (int i = 0; i < static_cast<int>(forces.size()); ++i) {
        sender.add(force(i, forces[static_cast<std::size_t>(i)]));
        if (i != lost) receiver.add(force(i, forces[static_cast<std::size_t>(i)]));
        if (i >= lost + 2) RC_ASSERT(sender.at(milliseconds(7)) == receiver.at(milliseconds(7)));
    }
}

TEST(ForceGate, SendsAtTheRefreshBoundWithoutAChange) {
    for (std::size_t codec = 1; codec < kHapticCodecNames.size(); ++codec) {
        CodecSettings settings = forces_by(static_cast<HapticCodec>(codec));
        settings.every = 1000;
        ForceGate gate(settings, kAnswerPeriod, true);
        for (int i = 0; i < 200; ++i)
            EXPECT_EQ(gate.due(stamp_of(i), force(i, -1)), i % 30 == 0) << kHapticCodecNames[codec] << i;
    }
}

TEST(ForceGate, SendsEveryNthAnswerAlsoWhereStampsJitter) {
    CodecSettings settings = forces_by(HapticCodec::kEveryNth);
    settings.every = 2;
    ForceGate gate(settings, kAnswerPeriod, true);
    for (int i = 0; i < 20; ++i) {
        ForceFeedback answer = force(i, -1);
        if (i % 4 == 2) answer.echo_time -= std::chrono::microseconds(20);
        EXPECT_EQ(gate.due(stamp_of(i), answer), i % 2 == 0) << i;
    }
}

TEST(ForceGate, SendsWhatIsNoNumberAtOnce) {
    for (const HapticCodec codec :
         {HapticCodec::kDeadband, HapticCodec::kDeadbandLinear, HapticCodec::kSendOnDelta}) {
        ForceGate gate(forces_by(codec), kAnswerPeriod, true);
        EXPECT_TRUE(gate.due(stamp_of(0), force(0, -1)));
        EXPECT_TRUE(gate.due(stamp_of(1), force(1, std::nan(""))));
        EXPECT_TRUE(gate.due(stamp_of(2), force(2, -1))) << "and the number after it";
    }
}

TEST(ForceGate, SendsAChangeOfHoldPhaseOrFixtureAtOnce) {
    ForceGate gate(forces_by(HapticCodec::kDeadband), kAnswerPeriod, true);
    EXPECT_TRUE(gate.due(stamp_of(0), force(0, -1)));
    ForceFeedback changed = force(1, -1);
    changed.needle_held = true;
    EXPECT_TRUE(gate.due(stamp_of(1), changed));
    changed.phase = TissuePhase::kContact;
    EXPECT_TRUE(gate.due(stamp_of(2), changed));
    changed.fixture_present = false;
    EXPECT_TRUE(gate.due(stamp_of(3), changed));
    EXPECT_FALSE(gate.due(stamp_of(4), changed));
}

// The packet that ends a slope of 300 N/s is lost.
TEST(ForceFill, AfterALossMakesUpNoMoreThanTheLastChange) {
    ForceFill fill(forces_by(HapticCodec::kDeadbandLinear), kAnswerPeriod);
    fill.heard(stamp_of(0), force(0, -1));
    fill.heard(stamp_of(1), force(1, -1.3));
    EXPECT_NEAR(fill.at(stamp_of(31)).force_total_N, -1.6, 1e-12);
}

TEST(ForceFill, StampsThatJitterMakeNoSlope) {
    ForceFill fill(forces_by(HapticCodec::kDeadbandLinear), kAnswerPeriod);
    fill.heard(stamp_of(0), force(0, -1));
    ForceFeedback close = force(0, -1.3);
    close.echo_time += std::chrono::microseconds(20);
    fill.heard(stamp_of(1), close);
    EXPECT_EQ(fill.at(stamp_of(11)).force_total_N, -1.3);
}

TEST(ForceLine, NeverChangesItsSign) {
    ForceLine line(forces_by(HapticCodec::kDeadbandLinear), kAnswerPeriod);
    line.add(force(0, -2));
    line.add(force(1, -1));
    EXPECT_EQ(line.at(milliseconds(40)), 0);
    line.add(force(2, 1));
    line.add(force(3, 0.5));
    EXPECT_EQ(line.at(milliseconds(40)), 0);
}

}  // namespace
}  // namespace thimble
