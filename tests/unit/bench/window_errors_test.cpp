// The quantiles of windows that thimble-bench netem speaks of.
#include "bench/network/window_errors.hpp"

#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace thimble {
namespace {

std::vector<double> one_to(std::size_t count) {
    std::vector<double> values(count);
    std::iota(values.begin(), values.end(), 1.0);
    return values;
}

TEST(ErrorWindows, AreMediansOverTheWindows) {
    ErrorWindows windows;
    for (const std::size_t count : {101, 1001, 201}) windows.add(one_to(count));
    EXPECT_EQ(windows.errors().w50_us, 101);
    EXPECT_EQ(windows.errors().w99_us, 199);
    EXPECT_DOUBLE_EQ(windows.errors().stalled, 1.0 / 3);
}

TEST(ErrorWindows, AWindowOfAFewIsNotJudged) {
    ErrorWindows windows;
    windows.add(std::vector<double>(19, 5000));
    EXPECT_EQ(windows.errors().w50_us, 0);
    windows.add(one_to(20));
    EXPECT_EQ(windows.errors().w50_us, 10);
    EXPECT_EQ(windows.errors().stalled, 0);
}

}  // namespace
}  // namespace thimble
