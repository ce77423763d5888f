// The UDP channel itself, between two ports of this machine.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/flow.hpp"
#include "common/runtime/wall_clock.hpp"
#include "tests/loopback/hostile_peer.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {
namespace {

class UdpPair : public testing::Test {
  protected:
    Endpoint at(int offset) const {
        return {"127.0.0.1", static_cast<std::uint16_t>(ports_.base() + offset)};
    }
    std::vector<std::uint8_t> receive() {
        Bytes bytes;
        wait_until([&] { return !(bytes = b_.receive()).empty(); });
        return {bytes.begin(), bytes.end()};
    }

    PortBlock ports_;
    UdpChannel a_{at(0), at(1)};
    UdpChannel b_{at(1), at(0)};
};

Header header(std::uint32_t sequence) {
    return {1, from_nanoseconds(1'000 + std::int64_t{sequence}), sequence, 1, Role::kMaster};
}

TEST_F(UdpPair, CarriesBytesBothWays) {
    const std::vector<std::uint8_t> there{1, 2, 3}, back{4, 5};
    a_.send(there);
    EXPECT_EQ(receive(), there);
    b_.send(back);
    Bytes bytes;
    EXPECT_TRUE(wait_until([&] { return !(bytes = a_.receive()).empty(); }));
    EXPECT_THAT(bytes, testing::ElementsAreArray(back));
    EXPECT_TRUE(b_.receive().empty());
}

TEST_F(UdpPair, SequenceWrapsWithoutAGap) {
    InboundFlow flow(Role::kMaster);
    std::uint32_t sequence = 0xFFFFFFF0;
    for (int i = 0; i < 32; ++i, ++sequence) {
        Header h = header(0);
        h.sequence = sequence;
        h.send_time += std::chrono::milliseconds{i};
        a_.send(datagram(h, NeedleCommand{}));
        const auto bytes = receive();
        const Message* message = flow.admit(wall_now(), bytes);
        ASSERT_NE(message, nullptr) << sequence;
        EXPECT_EQ(message->header.sequence, sequence);
    }
    EXPECT_EQ(sequence, 0x10U);
    Header before = header(0xFFFFFFFF);
    a_.send(datagram(before, NeedleCommand{}));
    EXPECT_EQ(flow.admit(wall_now(), receive()), nullptr);
    EXPECT_EQ(flow.counters().of(Refusal::kOutdated), 1U);
    EXPECT_EQ(flow.counters().accepted, 32U);
}

TEST_F(UdpPair, LongestIsCarriedLongerIsCounted) {
    a_.send(std::vector<std::uint8_t>(kMaxDatagramBytes + 1));
    a_.send(std::vector<std::uint8_t>(kMaxDatagramBytes));
    EXPECT_EQ(receive().size(), kMaxDatagramBytes);
    EXPECT_EQ(b_.counters().too_long, 1U);
    EXPECT_EQ(b_.counters().received, 1U);
}

TEST_F(UdpPair, OnlyThePeersHostIsHeard) {
    UdpChannel stranger(Endpoint{"127.0.0.2", 0}, at(1));
    stranger.send(std::vector<std::uint8_t>{6});
    a_.send(std::vector<std::uint8_t>{7});
    EXPECT_THAT(receive(), testing::ElementsAre(7));
    EXPECT_EQ(b_.counters().foreign_source, 1U);
}

TEST_F(UdpPair, APortInUseIsNamed) {
    try {
        UdpChannel third(at(1), at(0));
        FAIL() << "two sockets listen on one port";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kNetwork);
        EXPECT_THAT(error.what(), testing::HasSubstr("127.0.0.1:" + std::to_string(at(1).port)));
    }
}

TEST_F(UdpPair, NobodyListeningIsNoError) {
    UdpChannel lonely(at(2), at(3));
    for (int i = 0; i < 3; ++i) lonely.send(std::vector<std::uint8_t>{8});
    EXPECT_TRUE(lonely.receive().empty());
}

}  // namespace
}  // namespace thimble
