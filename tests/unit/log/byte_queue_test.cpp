// The queue between a loop and the thread that writes.
#include "common/log/byte_queue.hpp"

#include <numeric>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "tests/unit/master/allocation_count.hpp"

namespace thimble {
namespace {

std::vector<std::uint8_t> numbered(std::size_t size, std::uint8_t first) {
    std::vector<std::uint8_t> bytes(size);
    std::iota(bytes.begin(), bytes.end(), first);
    return bytes;
}

TEST(ByteQueue, GivesWhatItGotInOrder) {
    EXPECT_TRUE(
        rc::check("entries of any length, drained now and then", [](const std::vector<std::uint16_t>& sizes) {
            ByteQueue queue(4096);
            std::vector<std::uint16_t> pushed, drained;
            const auto drain = [&] {
                queue.drain([&](const ByteQueue::Entry& entry, Bytes bytes) {
                    RC_ASSERT(bytes.size() == entry.size);
                    RC_ASSERT(entry.time_ns == -entry.tag);
                    RC_ASSERT(std::vector(bytes.begin(), bytes.end()) ==
                              numbered(bytes.size(), static_cast<std::uint8_t>(entry.tag)));
                    drained.push_back(entry.tag);
                });
            };
            for (std::size_t i = 0; i < sizes.size(); ++i) {
                const auto tag = static_cast<std::uint16_t>(i);
                const auto bytes = numbered(sizes[i] % 513, static_cast<std::uint8_t>(tag));
                if (queue.push(tag, -tag, bytes)) pushed.push_back(tag);
                if (sizes[i] % 3 == 0) drain();
            }
            drain();
            RC_ASSERT(pushed == drained);
            RC_ASSERT(pushed.size() + queue.lost() == sizes.size());
        }));
}

TEST(ByteQueue, CountsWhatDoesNotFit) {
    ByteQueue queue(1024);
    const auto bytes = numbered(240, 0);  // 256 with its head
    for (int i = 0; i < 6; ++i) queue.push(0, 0, bytes);
    EXPECT_EQ(queue.lost(), 2U);
    int drained = 0;
    queue.drain([&](const ByteQueue::Entry&, Bytes) { ++drained; });
    EXPECT_EQ(drained, 4);
    EXPECT_TRUE(queue.push(0, 0, bytes));
}

TEST(ByteQueue, NeverAllocates) {
    ByteQueue queue(4096);
    const auto bytes = numbered(200, 0);
    const auto before = test::allocation_count();
    for (int i = 0; i < 100; ++i) {
        queue.push(0, 0, bytes);
        queue.drain([](const ByteQueue::Entry&, Bytes) {});
    }
    EXPECT_EQ(test::allocation_count(), before);
}

TEST(ByteQueue, TwoThreadsLoseNothingUncounted) {
    ByteQueue queue(4096);
    constexpr std::uint32_t kEntries = 50000;
    std::thread pusher([&queue] {
        for (std::uint32_t i = 0; i < kEntries; ++i) {
            const auto* from = static_cast<const std::uint8_t*>(static_cast<const void*>(&i));
            queue.push(0, i, {from, sizeof i});
        }
    });
    std::uint64_t drained = 0;
    std::int64_t newest = -1;
    const auto take = [&](const ByteQueue::Entry& entry, Bytes bytes) {
        std::uint32_t value = 0;
        std::memcpy(&value, bytes.data(), sizeof value);
        EXPECT_EQ(value, entry.time_ns);
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
