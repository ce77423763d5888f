#include "slave_sim/contact_timer.hpp"

#include <gtest/gtest.h>

#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// A third of a millisecond has no exact decimal: integers neither gain nor lose a sample over five seconds.
TEST(ContactTimer, CountsNanoseconds) {
    ContactTimer timer{seconds(5)};
    EXPECT_FALSE(timer.update(at(Duration{7}), true));
    EXPECT_FALSE(timer.update(at(Duration{7 + 4'999'999'999}), true));
    EXPECT_TRUE(timer.update(at(Duration{7 + 5'000'000'000}), true));
}

TEST(ContactTimer, LosingContactStartsAnew) {
    ContactTimer timer{seconds(5)};
    timer.update(at(seconds(0)), true);
    EXPECT_FALSE(timer.update(at(milliseconds(4999)), true));
    EXPECT_FALSE(timer.update(at(milliseconds(5000)), false));
    EXPECT_EQ(timer.time(), Duration::zero());
    EXPECT_FALSE(timer.update(at(milliseconds(5001)), true));
    EXPECT_EQ(timer.time(), Duration::zero());
    EXPECT_FALSE(timer.update(at(milliseconds(10000)), true));
    EXPECT_TRUE(timer.update(at(milliseconds(10001)), true));
}

TEST(ContactTimer, OneBeepPerTrial) {
    ContactTimer timer{milliseconds(10)};
    timer.update(at(milliseconds(0)), true);
    EXPECT_TRUE(timer.update(at(milliseconds(10)), true));
    timer.update(at(milliseconds(11)), false);
    timer.update(at(milliseconds(12)), true);
    EXPECT_FALSE(timer.update(at(milliseconds(30)), true));
    timer.reset();
    EXPECT_EQ(timer.time(), Duration::zero());
    timer.update(at(milliseconds(40)), true);
    EXPECT_TRUE(timer.update(at(milliseconds(50)), true));
}

}  // namespace
}  // namespace thimble
