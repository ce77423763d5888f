// The bytes of a link test, and what a numbered sequence has come to.
#include "thimble/link_test/probe_packet.hpp"

#include <algorithm>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "common/codec.hpp"
#include "thimble/link_test/echo_responder.hpp"

namespace thimble {
namespace {

ProbePacket sample() {
    return {ProbeKind::kEcho,
            14,
            0x1122334455667788,
            5,
            6,
            7,
            8,
            9,
            from_nanoseconds(10),
            from_nanoseconds(11),
            from_nanoseconds(12)};
}

std::vector<std::uint8_t> bytes_of(const ProbePacket& packet, std::size_t size = 104) {
    std::vector<std::uint8_t> bytes(size, 0xff);
    write_probe(packet, bytes);
    return bytes;
}

TEST(ProbePacket, ArrivesAsItWasSentAtEverySize) {
    for (const std::size_t size :
         {kProbeHeaderBytes, std::size_t{104}, std::size_t{1472}, kLargestProbeBytes}) {
        const auto read = read_probe(bytes_of(sample(), size));
        ASSERT_TRUE(read) << size;
        EXPECT_EQ(read->kind, ProbeKind::kEcho);
        EXPECT_EQ(read->port, 14);
        EXPECT_EQ(read->nonce, 0x1122334455667788U);
        EXPECT_EQ(read->sequence, 5U);
        EXPECT_EQ(read->far_received, 6U);
        EXPECT_EQ(read->far_duplicates, 7U);
        EXPECT_EQ(read->far_reordered, 8U);
        EXPECT_EQ(read->far_sent, 9U);
        EXPECT_EQ(to_nanoseconds(read->probe_sent), 10);
        EXPECT_EQ(to_nanoseconds(read->probe_arrived), 11);
        EXPECT_EQ(to_nanoseconds(read->echo_sent), 12);
    }
}

TEST(ProbePacket, AnythingElseIsNone) {
    const auto good = bytes_of(sample());
    for (std::size_t size = 0; size < good.size(); ++size)
        EXPECT_FALSE(read_probe(Bytes(good.data(), size))) << size;
    for (const std::size_t at : {0U, 3U, 4U, 60U, 61U, 62U, 63U}) {
        auto bad = good;
        bad[at] ^= 0x10;
        EXPECT_FALSE(read_probe(bad)) << at;
    }
    for (const int kind : {0, 7, 255}) {
        auto bad = good;
        bad[5] = static_cast<std::uint8_t>(kind);
        EXPECT_FALSE(read_probe(bad)) << kind;
    }
    auto negative = good;
    negative[39] = 0x80;
    EXPECT_FALSE(read_probe(negative));
    EXPECT_FALSE(read_probe(std::vector<std::uint8_t>(kLargestProbeBytes + 1)));
    Encoder encoder;
    EXPECT_FALSE(read_probe(encoder.encode(Header{}, Heartbeat{})));
    EXPECT_EQ(decode(good).refusal, Refusal::kForeignFormat);  // nor does a node take ours
}

TEST(ProbePacket, RandomBytesBehindAGoodStartAreReadOrRefused) {
    std::mt19937_64 random(1);
    int read_ones = 0;
    for (int i = 0; i < 100'000; ++i) {
        auto bytes = bytes_of(sample(), 64 + random() % 64);
        for (int n = 0; n < 3; ++n) bytes[4 + random() % 60] = static_cast<std::uint8_t>(random());
        if (const auto read = read_probe(bytes)) {
            const auto again = bytes_of(*read, bytes.size());
            ASSERT_TRUE(std::equal(again.begin(), again.begin() + kProbeHeaderBytes, bytes.begin()));
            ++read_ones;
        }
    }
    EXPECT_GT(read_ones, 1000);
    EXPECT_LT(read_ones, 99'000);
}

TEST(ArrivalCounter, CountsWhatCame) {
    ArrivalCounter counter;
    for (const std::uint32_t n : {1U, 2U, 4U, 3U, 4U, 2U, 7U}) counter.add(n);
    EXPECT_EQ(counter.distinct(), 5U);
    EXPECT_EQ(counter.duplicates(), 2U);
    EXPECT_EQ(counter.reordered(), 1U);
}

TEST(ArrivalCounter, GoesOnAcrossTheWrapAndAfterAGap) {
    ArrivalCounter counter;
    for (const std::uint32_t n : {0xfffffffeU, 0U, 0xffffffffU, 1U, 5000U, 4999U, 1U}) counter.add(n);
    EXPECT_EQ(counter.distinct(), 6U);
    EXPECT_EQ(counter.reordered(), 2U);
    EXPECT_EQ(counter.duplicates(), 1U);  // the second 1 lies too far behind
}

TEST(ArrivalCounter, AgreesWithASet) {
    EXPECT_TRUE(rc::check([](const std::vector<std::uint8_t>& numbers) {
        ArrivalCounter counter;
        std::set<std::uint8_t> seen;
        for (const std::uint8_t n : numbers) RC_ASSERT(counter.add(n) == seen.insert(n).second);
        RC_ASSERT(counter.distinct() == seen.size());
        RC_ASSERT(counter.distinct() + counter.duplicates() == numbers.size());
    }));
}

TEST(PortTraffic, SizesAreThoseOfSealedMessagesAndEveryPortHasSome) {
    Encoder encoder;
    const auto traffic = session_traffic();
    for (std::size_t i = 0; i < traffic.size(); ++i) {
        EXPECT_EQ(static_cast<std::size_t>(traffic[i].port), i);
        EXPECT_GE(traffic[i].bytes, kProbeHeaderBytes);
        EXPECT_LE(traffic[i].bytes, kMaxDatagramBytes);
        EXPECT_GT(traffic[i].rate_Hz, 0);
    }
    const auto of = [&](Port port) { return traffic[static_cast<std::size_t>(port)]; };
    // As seen on the wire under a lab key: the seal has 32 bytes, that of a hop to or from netem 32 more, a stop's code 18.
    EXPECT_EQ(of(Port::kSlaveNeedle).bytes, encoder.encode(Header{}, NeedleCommand{}).size() + 64);
    EXPECT_EQ(of(Port::kMasterForce).bytes, encoder.encode(Header{}, ForceFeedback{}).size() + 64);
    EXPECT_EQ(of(Port::kSessionRecord).bytes, encoder.encode(Header{}, ForceFeedback{}).size() + 32);
    EXPECT_EQ(of(Port::kMasterStop).bytes, encoder.encode(Header{}, StopOrder{}).size() + 18);
    EXPECT_EQ(of(Port::kMasterForce).rate_Hz, 1000);
    // Nothing longer ever passes a control channel than what is tried there.
    for (const std::size_t bytes :
         {encoder.encode(Header{}, SessionControl{}).size(), encoder.encode(Header{}, ClockProbe{}).size(),
          encoder.encode(Header{}, ClockReply{}).size()}) {
        EXPECT_LE(bytes + 32, of(Port::kMasterControl).bytes);
    }
}

TEST(PortTraffic, OnlyThePortsOfProgramsThatAreThere) {
    NetworkSettings network;
    EXPECT_EQ(ports_on(network, "127.0.0.1").size(), kPortCount);
    EXPECT_EQ(ports_on(network, "elsewhere").size(), kPortCount);  // the file says nothing about it
    network.hosts[static_cast<std::size_t>(Role::kSlaveSim)] = "10.0.0.2";
    EXPECT_EQ(ports_on(network, "10.0.0.2"),
              (std::vector{Port::kSlaveControl, Port::kSlaveNeedle, Port::kSlaveStop}));
}

}  // namespace
}  // namespace thimble
