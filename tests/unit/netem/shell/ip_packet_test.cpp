#include "netem/shell/ip_packet.hpp"

#include <gtest/gtest.h>

#include "tests/unit/netem/shell/sample_packets.hpp"

namespace thimble {
namespace {

TEST(IpPacket, OfTheProgramIsCarried) {
    const Octets v4 = ip4_packet(kUdp, "hello");
    const IpPacket packet = read_ip_packet(v4);
    EXPECT_EQ(packet.kind, IpKind::kData);
    EXPECT_FALSE(packet.v6);
    EXPECT_EQ(packet.bytes.size(), v4.size());
    EXPECT_EQ(Octets(packet.destination.begin(), packet.destination.end()), (Octets{10, 0, 0, 2}));

    const Octets v6 = ip6_packet(kUdp, {1, 2, 3});
    EXPECT_EQ(read_ip_packet(v6).kind, IpKind::kData);
    EXPECT_TRUE(read_ip_packet(v6).v6);
    EXPECT_EQ(read_ip_packet(v6).destination.size(), 16U);
    EXPECT_EQ(read_ip_packet(v6).destination[15], 2);
}

TEST(IpPacket, EndsWhereItsHeaderSays) {
    Octets padded = ip4_packet(kUdp, "hello");
    const std::size_t length = padded.size();
    padded.resize(length + 18);
    EXPECT_EQ(read_ip_packet(padded).bytes.size(), length);
}

TEST(IpPacket, OfTheKernelsStaysAtHome) {
    constexpr std::uint8_t kIgmp = 2, kIcmp = 1, kIcmp6 = 58, kHopByHop = 0;
    EXPECT_EQ(read_ip_packet(ip4_packet(kIgmp, "12345678")).kind, IpKind::kLocal);
    EXPECT_EQ(read_ip_packet(ip4_packet(kIcmp, "12345678")).kind, IpKind::kData);
    for (const std::uint8_t type : Octets{130, 133, 135, 136, 137, 143})
        EXPECT_EQ(read_ip_packet(ip6_packet(kIcmp6, {type, 0, 0, 0})).kind, IpKind::kLocal) << int{type};
    for (const std::uint8_t type : Octets{1, 2, 128, 129})
        EXPECT_EQ(read_ip_packet(ip6_packet(kIcmp6, {type, 0, 0, 0})).kind, IpKind::kData) << int{type};
    // MLD stands behind a router alert.
    const Octets report{kIcmp6, 0, 5, 2, 0, 0, 1, 0, 143, 0, 0, 0};
    EXPECT_EQ(read_ip_packet(ip6_packet(kHopByHop, report)).kind, IpKind::kLocal);
}

TEST(IpPacket, ThatIsCutOrNoneIsGarbage) {
    const Octets v4 = ip4_packet(kUdp, "hello"), v6 = ip6_packet(kUdp, {1, 2, 3});
    for (const Octets& whole : {v4, v6}) {
        for (std::size_t size = 0; size < whole.size(); ++size)
            EXPECT_EQ(read_ip_packet(Bytes(whole).first(size)).kind, IpKind::kGarbage) << size;
    }
    // A header and a length that are too short.
    for (const auto& [place, value] : {std::pair<std::size_t, std::uint8_t>{0, 0x44}, {3, 19}}) {
        Octets damaged = v4;
        damaged[place] = value;
        EXPECT_EQ(read_ip_packet(damaged).kind, IpKind::kGarbage) << place;
    }
    EXPECT_EQ(read_ip_packet(Octets(60, 0x35)).kind, IpKind::kGarbage);
}

TEST(SlirpFrames, HoldIpOrAreLeftOut) {
    Octets frame(kEthernetBytes, 0);
    EXPECT_TRUE(ip_of_frame(Bytes(frame).first(13)).empty());
    frame.resize(20, 7);
    frame[12] = 0x08;
    EXPECT_EQ(ip_of_frame(frame).size(), 6U);
    frame[13] = 0x06;  // ARP
    EXPECT_TRUE(ip_of_frame(frame).empty());
}

}  // namespace
}  // namespace thimble
