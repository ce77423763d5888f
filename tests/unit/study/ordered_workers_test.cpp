// The pool behind studies: order, exceptions, a stop.
#include "study/ordered_workers.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

namespace thimble {
namespace {

TEST(OrderedWorkers, ResultsComeInTheOrderOfTheItems) {
    for (const unsigned threads : {0U, 1U, 3U}) {
        OrderedWorkers<std::size_t> workers(100, threads, [](std::size_t i) { return i * i; });
        for (std::size_t i = 0; i < 100; ++i) ASSERT_EQ(workers.take(), i * i) << threads;
    }
}

TEST(OrderedWorkers, AnExceptionOfAThreadReachesTheCaller) {
    OrderedWorkers<int> workers(10, 2, [](std::size_t i) -> int {
        if (i == 3) throw std::runtime_error("the fourth");
        return 0;
    });
    EXPECT_THROW(
        {
            for (int i = 0; i < 10; ++i) workers.take();
        },
        std::runtime_error);
}

TEST(OrderedWorkers, AStopEndsTheItemsThatHaveNotBegun) {
    std::atomic<bool> stop{false};
    OrderedWorkers<std::size_t> workers(
        1000, 1,
        [&stop](std::size_t i) {
            if (i == 5) stop = true;
            return i;
        },
        &stop);
    std::size_t taken = 0;
    while (const auto result = workers.take()) EXPECT_EQ(*result, taken++);
    EXPECT_EQ(taken, 6U);
}

TEST(OrderedWorkers, APoolWithoutATakerEnds) {
    std::atomic<int> begun{0};
    {
        OrderedWorkers<int> workers(1000, 2, [&begun](std::size_t) { return ++begun; });
    }
    EXPECT_LE(begun, 4);  // two results wait per thread
}

}  // namespace
}  // namespace thimble
