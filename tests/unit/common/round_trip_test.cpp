#include "common/round_trip.hpp"

#include <gtest/gtest.h>

namespace thimble {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

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

// An echo from the future (a peer that makes it up) is no negative age.
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
