// A day at 1 kHz through a link: nothing drifts. How long the day is comes from the build: 24 h in release, shorter under
// sanitizers and in debug.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "netem/link_fates.hpp"
#include "netem/stages/delay_shape.hpp"
#include "tests/unit/netem/link_test_tools.hpp"

namespace thimble {
namespace {

using test::kKey;
using test::kMillisecond;
using test::NumberedPacket;

constexpr std::int64_t kDay_ms = THIMBLE_DAY_MS;

TEST(WholeDay, TheLastPacketIsAsPunctualAsTheFirst) {
    LinkSettings settings;
    settings.delay = 50 * kMillisecond;
    LinkModel link(settings, kKey, 0);
    const NumberedPacket packet(1);
    std::int64_t delivered = 0, unpunctual = 0;
    for (std::int64_t ms = 0; ms < kDay_ms; ++ms) {
        const SessionTime now = at(ms * kMillisecond);
        unpunctual += ms >= 50 && link.next_due() != now ? 1 : 0;
        delivered += link.pop_due(now).empty() ? 0 : 1;
        link.push(now, packet.bytes());
    }
    EXPECT_EQ(unpunctual, 0);
    EXPECT_EQ(delivered, kDay_ms - 50);
}

// Each packet takes a third of a millisecond, which is no whole number of nanoseconds, and the link is never idle.
TEST(WholeDay, ABusyLinkKeepsItsRate) {
    LinkSettings settings;
    settings.rate.bits_per_s = 8.0 * 100 * 3000;
    LinkModel link(settings, kKey, 0);
    const NumberedPacket packet(1, 100);
    for (int backlog = 0; backlog < 6; ++backlog) link.push(at({}), packet.bytes());
    const std::int64_t span_ms = kDay_ms / 6;
    std::int64_t sent = 0, worst_ns = 0;
    for (std::int64_t ms = 0; ms < span_ms; ++ms) {
        for (int i = 0; i < 3; ++i) link.push(at(ms * kMillisecond), packet.bytes());
        while (link.next_due() <= at((ms + 1) * kMillisecond)) {
            const SessionTime now = link.next_due();
            for (Bytes out = link.pop_due(now); !out.empty(); out = link.pop_due(now)) {
                ++sent;
                worst_ns = std::max(worst_ns, std::abs(3 * to_nanoseconds(now) - sent * 1'000'000) / 3);
            }
        }
    }
    EXPECT_GE(sent, 3 * span_ms - 1);
    EXPECT_LE(worst_ns, 1);
}

// Mean and spread of a million delays at the day's two ends.
TEST(WholeDay, JitterIsTheSameInTheEvening) {
    constexpr std::uint64_t kPackets = 1'000'000;
    LinkSettings settings;
    settings.delay = 50 * kMillisecond;
    settings.jitter = {.shape = JitterShape::kGamma, .spread = 8 * kMillisecond, .correlation = 0.5};
    for (const std::uint64_t first : {std::uint64_t{0}, std::uint64_t{86'400'000} - kPackets}) {
        LinkFates fates(kKey, 0);
        fates.configure(settings, std::make_shared<const DelayShape>(settings.jitter, settings.delay));
        double sum_ms = 0, squares_ms2 = 0;
        for (std::uint64_t i = 0; i < kPackets; ++i) {
            const double delay_ms =
                1e3 * to_seconds(
                          fates.decide(first + i, static_cast<std::int64_t>(first + i) * kMillisecond).delay);
            sum_ms += delay_ms - 50;
            squares_ms2 += (delay_ms - 50) * (delay_ms - 50);
        }
        // Correlation makes the mean of so many some sqrt(3) times as uncertain; four standard errors.
        const double n = static_cast<double>(kPackets);
        EXPECT_NEAR(sum_ms / n, 0, 4 * 8 * std::sqrt(3 / n)) << first;
        EXPECT_NEAR(std::sqrt(squares_ms2 / n), 8, 0.1) << first;
    }
}

}  // namespace
}  // namespace thimble
