#include "common/queue_channel.hpp"

#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "tests/allocation_count.hpp"
#include "tests/unit/common/packet.hpp"

namespace thimble {
namespace {

TEST(QueueChannel, FirstInFirstOutBothWays) {
    QueueChannel a, b;
    a.connect(b);
    b.connect(a);
    a.send(Packet{1});
    a.send(Packet{2, 3});
    b.send(Packet{4});
    EXPECT_EQ(copy(b.receive()), (Packet{1}));
    EXPECT_EQ(copy(b.receive()), (Packet{2, 3}));
    EXPECT_TRUE(b.receive().empty());
    EXPECT_EQ(copy(a.receive()), (Packet{4}));
    EXPECT_TRUE(a.receive().empty());
}

TEST(QueueChannel, OverflowLosesTheNewestAndCounts) {
    QueueChannel a, b(4);
    a.connect(b);
    for (std::uint8_t i = 0; i < 6; ++i) a.send(Packet{i});
    EXPECT_EQ(b.lost(), 3U);  // one slot is kept for the reader
    for (std::uint8_t i = 0; i < 3; ++i) EXPECT_EQ(copy(b.receive()), (Packet{i}));
    EXPECT_TRUE(b.receive().empty());
    a.send(Packet{9});
    EXPECT_EQ(copy(b.receive()), (Packet{9}));
}

// "Valid until the next call": also while the peer goes on sending.
TEST(QueueChannel, WhatIsBeingReadIsNotOverwritten) {
    for (std::uint8_t before = 0; before < 9; ++before) {
        for (const bool drained : {false, true}) {
            QueueChannel a, b(4);
            a.connect(b);
            for (std::uint8_t i = 0; i < before; ++i) {
                a.send(Packet{i});
                EXPECT_EQ(copy(b.receive()), (Packet{i}));
                if (drained) {
                    EXPECT_TRUE(b.receive().empty());
                }
            }
            a.send(Packet{7, 7});
            const Bytes held = b.receive();
            for (std::uint8_t i = 0; i < 10; ++i) a.send(Packet{i, i});
            EXPECT_EQ(copy(held), (Packet{7, 7})) << int{before};
            EXPECT_EQ(b.lost(), 7U);
            for (std::uint8_t i = 0; i < 3; ++i) EXPECT_EQ(copy(b.receive()), (Packet{i, i}));
            EXPECT_TRUE(b.receive().empty());
        }
    }
}

TEST(QueueChannel, ADatagramOfAnySizeUpToTheLimit) {
    QueueChannel a, b;
    a.connect(b);
    a.send(Packet(kMaxDatagramBytes + 1, 1));
    EXPECT_EQ(b.lost(), 1U);
    const Packet largest(kMaxDatagramBytes, 2);
    a.send(largest);
    EXPECT_EQ(copy(b.receive()), largest);
}

TEST(QueueChannel, WakesItsReader) {
    std::uint32_t mask = 0;
    QueueChannel a, b(2);
    a.connect(b);
    b.wake(&mask, 1U << 5);
    a.send(Packet{1});
    EXPECT_EQ(mask, 1U << 5);
    mask = 0;
    a.send(Packet{2});  // full: nothing arrived, so no process wakes
    EXPECT_EQ(mask, 0U);
}

TEST(QueueChannel, NobodyAtTheOtherEnd) {
    QueueChannel alone;
    alone.send(Packet{1});
    EXPECT_TRUE(alone.receive().empty());
}

TEST(QueueChannel, SendingAllocatesNothing) {
    QueueChannel a, b;
    a.connect(b);
    const std::array<std::uint8_t, 100> datagram{};
    const std::uint64_t before = test::allocation_count();
    std::size_t bytes = 0;
    for (int i = 0; i < 1000; ++i) {
        a.send(datagram);
        bytes += b.receive().size();
    }
    EXPECT_EQ(test::allocation_count() - before, 0U);
    EXPECT_EQ(bytes, 100'000U);
}

}  // namespace
}  // namespace thimble
