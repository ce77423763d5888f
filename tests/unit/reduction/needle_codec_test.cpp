// Needle commands that are not sent: how wrong the slave's end may be, and for how long.
#include "common/reduction/needle_codec.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace thimble {
namespace {

using std::chrono::milliseconds;

constexpr Duration kPeriod = milliseconds(1);
constexpr double kRounding = 1e-12;

CodecSettings with(HapticCodec codec) {
    CodecSettings settings;
    settings.command = codec;
    return settings;
}

HapticCodec any_codec() {
    return *rc::gen::element(HapticCodec::kDeadband, HapticCodec::kDeadbandLinear, HapticCodec::kEveryNth,
                             HapticCodec::kSendOnDelta);
}

// A hand that changes its mind: pieces of constant velocity, with or without a force against it.
std::vector<NeedleCommand> any_motion() {
    std::vector<NeedleCommand> motion;
    NeedleCommand now;
    for (const int piece : *rc::gen::container<std::vector<int>>(6, rc::gen::inRange(-40, 60))) {
        now.velocity_needle_m_per_s = piece * 1e-3;
        now.velocity_hand_m_per_s = now.velocity_needle_m_per_s / 3;
        now.force_hand_N = *rc::gen::inRange(-1, 3);
        const int samples = *rc::gen::inRange(1, 120);
        motion.reserve(motion.size() + static_cast<std::size_t>(samples));
        for (int i = 0; i < samples; ++i) {
            now.position_needle_estimate_m += now.velocity_needle_m_per_s * 1e-3;
            now.position_needle_m = now.position_needle_estimate_m;
            now.position_hand_m = now.position_needle_m / 3;
            motion.push_back(now);
        }
    }
    return motion;
}

SessionTime time_of(std::size_t sample) { return SessionTime{milliseconds(1000 + sample)}; }

// `fill` hears of a command that was sent at `stamp`.
bool heard_by(NeedleFill& fill, SessionTime now, SessionTime stamp, std::uint64_t instance = 0) {
    Header header;
    header.send_time = stamp;
    header.instance = instance;
    return fill.heard(now, header, {});
}

TEST(NeedleGate, SendsEverySampleWithoutACodecAndEveryNth) {
    NeedleGate plain(with(HapticCodec::kNone)), every_nth(with(HapticCodec::kEveryNth));
    for (std::size_t i = 0; i < 100; ++i) {
        EXPECT_TRUE(plain.due(time_of(i), {})) << i;
        EXPECT_EQ(every_nth.due(time_of(i), {}), i % 10 == 0) << i;
    }
}

TEST(NeedleGate, SendsAtOnceWhenTheVelocityLeavesItsDeadband) {
    NeedleGate gate(with(HapticCodec::kDeadband));
    NeedleCommand command;
    command.velocity_needle_m_per_s = 0.1;
    EXPECT_TRUE(gate.due(time_of(0), command));
    command.velocity_needle_m_per_s = 0.1099;
    EXPECT_FALSE(gate.due(time_of(1), command));
    command.velocity_needle_m_per_s = 0.1101;
    EXPECT_TRUE(gate.due(time_of(2), command));
    command.velocity_needle_m_per_s = std::nan("");
    EXPECT_TRUE(gate.due(time_of(3), command)) << "is refused where it arrives, not here";
}

// After a loss the next packet comes within the refresh bound.
RC_GTEST_PROP(NeedleGate, IsNeverSilentForLongerThanTheRefreshBound, ()) {
    const CodecSettings settings = with(any_codec());
    NeedleGate gate(settings);
    const std::vector<NeedleCommand> motion = any_motion();
    SessionTime sent = time_of(0);
    for (std::size_t i = 0; i < motion.size(); ++i) {
        if (gate.due(time_of(i), motion[i])) sent = time_of(i);
        RC_ASSERT(time_of(i) - sent < settings.refresh);
    }
}

// Both ends over a network with a constant delay: for each of the master's samples the slave has one of the same stamp, and it is
// wrong by no more than delta.
RC_GTEST_PROP(NeedleFill, IsWrongByNoMoreThanDelta, ()) {
    const CodecSettings settings = with(
        *rc::gen::element(HapticCodec::kDeadband, HapticCodec::kDeadbandLinear, HapticCodec::kSendOnDelta));
    const Duration delay = milliseconds(*rc::gen::inRange(0, 100));
    NeedleGate gate(settings);
    NeedleFill fill(settings, kPeriod);
    const std::vector<NeedleCommand> motion = any_motion();
    for (std::size_t i = 0; i < motion.size(); ++i) {
        NeedleCommand there = motion[i];
        if (gate.due(time_of(i), motion[i])) {
            Header header;
            header.send_time = time_of(i);
            RC_ASSERT(fill.heard(time_of(i) + delay, header, {motion[i], {}}));
        } else {
            const auto* sample = fill.take(time_of(i) + delay + kPeriod / 2);
            RC_ASSERT(sample != nullptr);
            RC_ASSERT(sample->stamp == time_of(i));
            there = sample->message.command;
        }
        RC_ASSERT(std::abs(there.position_needle_estimate_m - motion[i].position_needle_estimate_m) <=
                  settings.delta_position_m + kRounding);
        RC_ASSERT(std::abs(there.position_needle_m - motion[i].position_needle_m) <=
                  settings.delta_position_m + kRounding);
    }
}

// Packets that are lost, late, and in bursts: stamps only grow, and never run ahead of the newest packet by more than the bound.
RC_GTEST_PROP(NeedleFill, StampsGrowAndStayNearTheNewestPacket, ()) {
    const CodecSettings settings = with(any_codec());
    NeedleFill fill(settings, kPeriod);
    SessionTime last{}, newest{};
    for (std::size_t i = 0; i < 400; ++i) {
        const SessionTime now = time_of(i);
        if (*rc::gen::inRange(0, 10) == 0) {
            newest = std::max(newest, now - milliseconds(*rc::gen::inRange(0, 80)));
            if (heard_by(fill, now, newest)) {
                RC_ASSERT(newest > last);
                last = newest;
            }
        }
        if (const auto* sample = fill.take(now)) {
            RC_ASSERT(sample->stamp > last);
            RC_ASSERT(sample->stamp - newest <= settings.refresh);
            last = sample->stamp;
        }
    }
}

// No work against the force that the hand feels, unless a command orders it.
RC_GTEST_PROP(NeedleFill, DoesNotPushInwardsAgainstAForceByItself, ()) {
    NeedleCommand sent;
    sent.position_needle_m = *rc::gen::inRange(-100, 100) * 1e-3;
    sent.velocity_needle_m_per_s = *rc::gen::inRange(-1000, 1000) * 1e-3;
    sent.force_hand_N = *rc::gen::inRange(1, 12);
    const Duration since = milliseconds(*rc::gen::inRange(0, 30));
    RC_ASSERT(reconstructed(sent, since, any_codec()).position_needle_m <= sent.position_needle_m);
}

TEST(NeedleFill, EndsAtTheRefreshBoundAndGoesOnWithTheNextPacket) {
    NeedleFill fill(with(HapticCodec::kDeadbandLinear), kPeriod);
    EXPECT_TRUE(heard_by(fill, time_of(0), time_of(0)));
    int samples = 0;
    for (std::size_t i = 1; i < 100; ++i) samples += fill.take(time_of(i)) != nullptr ? 1 : 0;
    EXPECT_EQ(samples, 30);
    EXPECT_EQ(fill.next(), kNever);
    EXPECT_TRUE(heard_by(fill, time_of(100), time_of(90)));
    EXPECT_LT(fill.next(), time_of(102));
}

// A packet that is late, with a stamp a little beyond the sample that stood for it: the needle waits for its next sample.
TEST(NeedleFill, ALatePacketWhoseStampJittersIsNotAnsweredTwice) {
    NeedleFill fill(with(HapticCodec::kDeadbandLinear), kPeriod);
    EXPECT_TRUE(heard_by(fill, time_of(0), time_of(0)));
    ASSERT_NE(fill.take(time_of(1) + kPeriod / 2), nullptr);
    EXPECT_FALSE(heard_by(fill, time_of(1) + kPeriod * 6 / 10, time_of(1) + std::chrono::microseconds(20)));
    const auto* next = fill.take(time_of(2) + kPeriod / 2);
    ASSERT_NE(next, nullptr);
    EXPECT_EQ(next->stamp, time_of(2));
}

TEST(NeedleFill, AnotherMasterHasAnotherClock) {
    NeedleFill fill(with(HapticCodec::kDeadband), kPeriod);
    EXPECT_TRUE(heard_by(fill, time_of(0), time_of(5000)));
    EXPECT_FALSE(heard_by(fill, time_of(1), time_of(0)));
    EXPECT_TRUE(heard_by(fill, time_of(2), time_of(0), 1));
}

}  // namespace
}  // namespace thimble
