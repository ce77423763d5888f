// The pool behind studies: order, exceptions, a stop.
#include <array>
#include <pthread.h>
#include <stdexcept>
#include <system_error>
#include <vector>

#include <gtest/gtest.h>

#include "study/worker_pool.hpp"

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

// Item 0 takes away the room for stacks, so that hardly a thread after the first can start.
TEST(OrderedWorkers, FewerThreadsThanAskedForDoTheWork) {
    pthread_attr_t before, without_room;
    pthread_getattr_default_np(&before);
    pthread_attr_init(&without_room);
    pthread_attr_setstacksize(&without_room, std::size_t{1} << 46);
    {
        OrderedWorkers<std::size_t> workers(100, 500, [&](std::size_t i) {
            if (i == 0) pthread_setattr_default_np(&without_room);
            return i;
        });
        for (std::size_t i = 0; i < 100; ++i) ASSERT_EQ(workers.take(), i);
        EXPECT_THROW(OrderedWorkers<int>(1, 1, [](std::size_t) { return 0; }), std::system_error);
    }
    pthread_setattr_default_np(&before);
    pthread_attr_destroy(&without_room);
}

TEST(OrderedWorkers, APoolWithoutATakerEnds) {
    std::atomic<int> begun{0};
    {
        OrderedWorkers<int> workers(1000, 2, [&begun](std::size_t) { return ++begun; });
    }
    EXPECT_LE(begun, 4);  // two results wait per thread
}

TEST(WorkerPool, HandsEachResultOverInOrderAndSaysWhetherAllAreDone) {
    std::vector<std::size_t> taken;
    const auto square = [](std::size_t i) { return i * i; };
    const auto take = [&taken](std::size_t result) { taken.push_back(result); };
    EXPECT_TRUE(run_in_order<std::size_t>(4, 3, nullptr, square, take));
    EXPECT_EQ(taken, (std::vector<std::size_t>{0, 1, 4, 9}));
    const std::atomic<bool> stop{true};
    EXPECT_FALSE(run_in_order<std::size_t>(4, 3, &stop, square, take));
    const auto fail = [](std::size_t) -> std::size_t { throw std::runtime_error("no"); };
    EXPECT_THROW(run_in_order<std::size_t>(4, 1, nullptr, fail, take), std::runtime_error);
}

// As between ranks.
template <class Result>
Result sent(const Result& result) {
    std::string bytes;
    append_bytes(bytes, result);
    Result read{};
    read_bytes(bytes, read);
    return read;
}

TEST(WorkerPool, AResultIsTheSameBehindTheWire) {
    EXPECT_EQ(sent(std::string("a,b\n")), "a,b\n");
    EXPECT_EQ(sent(std::string()), "");
    EXPECT_EQ(sent(0.1), 0.1);
    EXPECT_EQ(sent(std::vector<std::array<double, 2>>{{1, 2}, {3, 4}}),
              (std::vector<std::array<double, 2>>{{1, 2}, {3, 4}}));
}

}  // namespace
}  // namespace thimble
