// The queue between a loop and the thread that writes.
#include "common/log/byte_queue.hpp"

#include <algorithm>
#include <numeric>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/allocation_count.hpp"

namespace thimble {
namespace {

std::vector<std::uint8_t> numbered(std::size_t size, std::uint8_t first) {
    std::vector<std::uint8_t> bytes(size);
    std::iota(bytes.begin(), bytes.end(), first);
    return bytes;
}

TEST(ByteQueue, CountsWhatDoesNotFit) {
    ByteQueue queue(1024);
    const auto bytes = numbered(240, 0);  // 256 with its head
    const auto before = test::allocation_count();
    for (int i = 0; i < 6; ++i) queue.push(0, 0, bytes);
    EXPECT_EQ(test::allocation_count(), before);
    EXPECT_EQ(queue.lost(), 2U);
    int drained = 0;
    queue.drain([&](const ByteQueue::Entry&, Bytes) { ++drained; });
    EXPECT_EQ(drained, 4);
    EXPECT_TRUE(queue.push(0, 0, bytes));
}

TEST(ByteQueue, NeverAllocatesWhenItWraps) {
    ByteQueue queue(4096);
    const auto bytes = numbered(200, 0);
    int drained = 0;
    const auto before = test::allocation_count();
    for (int i = 0; i < 100; ++i) {
        queue.push(0, 0, bytes);
        queue.drain([&](const ByteQueue::Entry&, Bytes) { ++drained; });
    }
    EXPECT_EQ(test::allocation_count(), before);
    EXPECT_EQ(drained, 100);
}

TEST(ByteQueue, TwoThreadsLoseNothingUncounted) {
    ByteQueue queue(4096);
    constexpr std::uint32_t kEntries = 50000;
    std::thread pusher([&queue] {
        const auto bytes = numbered(256 + kMaxDatagramBytes, 0);
        for (std::uint32_t i = 0; i < kEntries; ++i)
            queue.push(7, i, Bytes(bytes).subspan(i % 256, i % (kMaxDatagramBytes + 1)));
    });
    std::uint64_t drained = 0;
    std::int64_t newest = -1;
    const auto take = [&](const ByteQueue::Entry& entry, Bytes bytes) {
        EXPECT_EQ(entry.tag, 7);
        EXPECT_EQ(bytes.size(), static_cast<std::uint64_t>(entry.time_ns) % (kMaxDatagramBytes + 1));
        EXPECT_TRUE(
            std::ranges::equal(bytes, numbered(bytes.size(), static_cast<std::uint8_t>(entry.time_ns))));
        EXPECT_GT(entry.time_ns, newest);
        newest = entry.time_ns;
        ++drained;
    };
    while (drained + queue.lost() < kEntries) queue.drain(take);
    pusher.join();
    queue.drain(take);
    EXPECT_EQ(drained + queue.lost(), kEntries);
}

}  // namespace
}  // namespace thimble
