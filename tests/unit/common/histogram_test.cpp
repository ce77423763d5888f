#include "common/histogram.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "common/force_age.hpp"
#include "tests/allocation_count.hpp"

namespace thimble {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

// Durations of every size up to 2^41 ns, evenly over the octaves.
std::vector<std::int64_t> draw_samples() {
    std::vector<std::int64_t> samples;
    const auto count = *rc::gen::inRange(1, 200);
    for (int i = 0; i < count; ++i) {
        const auto octave = *rc::gen::inRange(0, 42);
        samples.push_back(*rc::gen::inRange<std::int64_t>(0, std::int64_t{1} << octave));
    }
    return samples;
}

TEST(Histogram, QuantilesAreTheSortedSamplesToTheirBound) {
    EXPECT_TRUE(rc::check([] {
        std::vector<std::int64_t> samples = draw_samples();
        Histogram histogram;
        for (const std::int64_t ns : samples) histogram.add(Duration{ns});
        std::sort(samples.begin(), samples.end());
        RC_ASSERT(histogram.count() == samples.size());
        RC_ASSERT(histogram.best().count() == samples.front());
        RC_ASSERT(histogram.worst().count() == samples.back());
        for (const double q : {0.0, 0.25, 0.5, 0.9, 0.99, 1.0}) {
            const auto rank = static_cast<std::size_t>(q * static_cast<double>(samples.size() - 1));
            const auto expected = static_cast<double>(samples[rank]);
            const auto given = static_cast<double>(histogram.quantile(q).count());
            RC_ASSERT(std::fabs(given - expected) <= 0.004 * expected);
        }
    }));
}

TEST(Histogram, ConstantsAreExact) {
    for (const Duration value : {Duration{0}, Duration{127}, Duration{129}, Duration{1'000'003},
                                 Duration{milliseconds{50}}, Duration{std::chrono::seconds{1234}}}) {
        Histogram histogram;
        for (int i = 0; i < 1000; ++i) histogram.add(value);
        for (const double q : {0.0, 0.5, 1.0}) EXPECT_EQ(histogram.quantile(q), value);
        EXPECT_EQ(histogram.best(), value);
        EXPECT_EQ(histogram.worst(), value);
    }
}

TEST(Histogram, TwoMergedAreOneOfAllSamples) {
    Histogram first, second, all;
    for (int ns = 0; ns < 300; ++ns) {
        (ns % 3 == 0 ? first : second).add(Duration{ns * ns});
        all.add(Duration{ns * ns});
    }
    first.merge(second);
    first.merge(Histogram{});
    EXPECT_EQ(first.count(), 300U);
    EXPECT_EQ(first.best(), all.best());
    EXPECT_EQ(first.worst(), all.worst());
    for (const double q : {0.25, 0.5, 0.99}) EXPECT_EQ(first.quantile(q), all.quantile(q));
}

TEST(Histogram, SmallValuesAreExact) {
    Histogram histogram;
    for (int ns = 0; ns <= 255; ++ns) histogram.add(Duration{ns});
    for (int ns = 0; ns <= 255; ++ns) EXPECT_EQ(histogram.quantile(ns / 255.0).count(), ns);
}

TEST(Histogram, EmptyNegativeAndEndless) {
    Histogram histogram;
    EXPECT_EQ(histogram.quantile(0.5), Duration{0});
    EXPECT_EQ(histogram.worst(), Duration{0});
    histogram.add(Duration{-5});
    EXPECT_EQ(histogram.best(), Duration{0});
    histogram.add(Duration::max());
    EXPECT_EQ(histogram.worst(), Duration::max());
    EXPECT_EQ(histogram.count(), 2U);
}

TEST(Histogram, ClearForgetsEverything) {
    Histogram histogram;
    histogram.add(milliseconds{5});
    histogram.clear();
    EXPECT_EQ(histogram.count(), 0U);
    histogram.add(milliseconds{7});
    EXPECT_EQ(histogram.best(), milliseconds{7});
    EXPECT_EQ(histogram.worst(), milliseconds{7});
    EXPECT_EQ(histogram.quantile(0.5), milliseconds{7});
}

TEST(Histogram, AddingAllocatesNothing) {
    Histogram histogram;
    const std::uint64_t before = test::allocation_count();
    for (int i = 0; i < 1000; ++i) histogram.add(Duration{std::int64_t{1} << (i % 62)});
    const Duration median = histogram.quantile(0.5);
    EXPECT_EQ(test::allocation_count() - before, 0U);
    EXPECT_GT(median, Duration{0});
}

TEST(RoundTrip, AgeIsFromTheEchoedStampToNow) {
    RoundTrip round_trip;
    ForceFeedback feedback;
    feedback.hold_time = microseconds{300};
    for (int i = 0; i < 10; ++i) {
        feedback.echo_time = SessionTime{seconds{5} + milliseconds{i}};
        round_trip.add(feedback.echo_time + milliseconds{51}, feedback);
    }
    EXPECT_EQ(round_trip.age().count(), 10U);
    EXPECT_EQ(round_trip.age().quantile(0.5), milliseconds{51});
    EXPECT_EQ(round_trip.hold().quantile(0.5), microseconds{300});
}

TEST(RoundTrip, AnEchoFromTheFutureCountsAsNow) {
    RoundTrip round_trip;
    ForceFeedback feedback;
    feedback.echo_time = SessionTime{seconds{9}};
    round_trip.add(SessionTime{seconds{5}}, feedback);
    EXPECT_EQ(round_trip.age().worst(), Duration{0});
}

TEST(RoundTrip, ClearForgetsBoth) {
    RoundTrip round_trip;
    round_trip.add(SessionTime{seconds{5}}, ForceFeedback{});
    round_trip.clear();
    EXPECT_EQ(round_trip.age().count(), 0U);
    EXPECT_EQ(round_trip.hold().count(), 0U);
}

}  // namespace
}  // namespace thimble
