#include "netem/packet_store.hpp"

#include <cstring>
#include <deque>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "tests/unit/netem/link_test_tools.hpp"

namespace thimble::test {
namespace {

TEST(PacketStore, SizeClassesGrowByAtMostAHalf) {
    std::size_t last = 0;
    for (std::size_t lines = 1; lines <= 1100; ++lines) {
        const std::size_t size_class = size_class_of(lines);
        ASSERT_GE(size_class, last);
        ASSERT_LE(size_class, last + 1);
        last = size_class;
    }
    EXPECT_EQ(last, 20U);
}

TEST(PacketStore, KeepsWhatItHolds) {
    EXPECT_TRUE(rc::check("no packet touches another", [] {
        PacketStore store;
        std::deque<std::pair<Packet*, std::vector<std::uint8_t>>> held;
        for (int i = 0; i < 200; ++i) {
            const bool small = *rc::gen::weightedElement<bool>({{9, true}, {1, false}});
            const auto size = *rc::gen::inRange<std::size_t>(1, small ? 600 : kLargestDatagramBytes + 1);
            const std::vector<std::uint8_t> bytes(size, static_cast<std::uint8_t>(i));
            held.emplace_back(store.take(bytes), bytes);
            if (held.size() > 20) {
                RC_ASSERT(std::memcmp(held.front().first->data(), held.front().second.data(),
                                      held.front().second.size()) == 0);
                store.give_back(held.front().first);
                held.pop_front();
            }
        }
        for (const auto& [packet, bytes] : held) {
            RC_ASSERT(packet->size == bytes.size());
            RC_ASSERT(std::memcmp(packet->data(), bytes.data(), bytes.size()) == 0);
        }
    }));
}

TEST(PacketStore, MemoryIsProportionalToWhatIsInFlight) {
    EXPECT_EQ(PacketStore().reserved_bytes(), 0U);
    for (const std::size_t size : {64U, 200U, 1400U, 60'000U}) {
        LinkModel link({.delay = std::chrono::seconds{1}, .capacity = 100'000}, kKey, 0);
        const std::vector<std::uint8_t> bytes(size);
        constexpr std::size_t kPackets = 1000;
        for (std::size_t i = 0; i < kPackets; ++i) link.push(at({}), bytes);
        // A third of a block and half of a slab may be unused, and 40 bytes are the packet's own.
        EXPECT_LE(link.memory_bytes(), 2 * kPackets * (size + 40 + 64) * 3 / 2) << size;
        EXPECT_GE(link.memory_bytes(), kPackets * size);
        const std::size_t grown = link.memory_bytes();
        for (int lap = 1; lap < 5; ++lap) {
            while (!link.pop_due(at(std::chrono::seconds{lap})).empty()) {
            }
            for (std::size_t i = 0; i < kPackets; ++i) link.push(at(std::chrono::seconds{lap}), bytes);
        }
        EXPECT_EQ(link.memory_bytes(), grown);
    }
}

}  // namespace
}  // namespace thimble::test
