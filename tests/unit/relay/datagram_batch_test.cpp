#include "netem/relay/datagram_batch.hpp"

#include <arpa/inet.h>
#include <string>
#include <sys/socket.h>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/runtime/udp_channel.hpp"
#include "common/runtime/udp_socket.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

UdpAddress any_port_here() { return {htonl(INADDR_LOOPBACK), 0}; }

// First byte: its number.
std::vector<std::uint8_t> numbered(std::size_t number, std::size_t size) {
    std::vector<std::uint8_t> bytes(size, 7);
    bytes[0] = static_cast<std::uint8_t>(number);
    return bytes;
}

bool has_ipv6() {
    try {
        UdpSocket::listening(read_udp_address("[::1]:0", ""));
        return true;
    } catch (const Error&) {
        return false;
    }
}

class Batches : public testing::TestWithParam<bool> {
  protected:
    // Sends datagrams of these sizes, and returns what the sink got.
    std::vector<std::vector<std::uint8_t>> through(const std::vector<std::size_t>& sizes) {
        std::vector<std::vector<std::uint8_t>> sent;
        sent.reserve(sizes.size());
        for (const std::size_t size : sizes) sent.push_back(numbered(sent.size(), size));
        const UdpSocket client = UdpSocket::connected(sink_.local());
        for (const auto& datagram : sent) batch_.add(datagram, nullptr);
        EXPECT_THAT(batch_.send(client.descriptor()), testing::Each(true));
        EXPECT_EQ(batch_.size(), 0U);
        return received(sink_);
    }
    static std::vector<std::vector<std::uint8_t>> received(const UdpSocket& sink) {
        std::vector<std::vector<std::uint8_t>> all;
        ReceiveBatch in;
        for (std::size_t count = in.receive(sink.descriptor()); count > 0;
             count = in.receive(sink.descriptor())) {
            for (std::size_t i = 0; i < count; ++i) all.emplace_back(in[i].bytes.begin(), in[i].bytes.end());
        }
        return all;
    }
    static void expect_sizes(const std::vector<std::vector<std::uint8_t>>& got,
                             const std::vector<std::size_t>& sizes) {
        ASSERT_EQ(got.size(), sizes.size());
        for (std::size_t i = 0; i < got.size(); ++i) EXPECT_EQ(got[i], numbered(i, sizes[i])) << i;
    }

    UdpSocket sink_ = UdpSocket::listening(any_port_here());
    SendBatch batch_{GetParam()};
};

TEST_P(Batches, OneSizeArrivesAsItWasSent) {
    const std::vector<std::size_t> sizes(SendBatch::kSize, 144);
    expect_sizes(through(sizes), sizes);
}

TEST_P(Batches, RunsOfSeveralSizesKeepTheirOrder) {
    std::vector<std::size_t> sizes(20, 100);
    sizes.insert(sizes.end(), 3, 50);
    sizes.insert(sizes.end(), 17, 101);
    sizes.push_back(1);
    sizes.insert(sizes.end(), 16, SendBatch::kLongestJoined);
    expect_sizes(through(sizes), sizes);
}

TEST_P(Batches, LongOnesStaySingle) {
    const std::vector<std::size_t> sizes(18, 9000);
    expect_sizes(through(sizes), sizes);
}

TEST_P(Batches, EveryReceiverGetsItsOwn) {
    const UdpSocket other = UdpSocket::listening(any_port_here()),
                    client = UdpSocket::listening(any_port_here());
    const UdpAddress here = sink_.local(), there = other.local();
    const auto bytes = numbered(0, 30);
    for (std::size_t i = 0; i < 40; ++i) batch_.add(bytes, i < 23 ? &here : &there);
    EXPECT_THAT(batch_.send(client.descriptor()), testing::Each(true));
    EXPECT_EQ(received(sink_).size(), 23U);
    EXPECT_EQ(received(other).size(), 17U);
}

// Only more bytes than a datagram can hold are refused.
TEST_P(Batches, ARefusalIsOfThatDatagramOnly) {
    const UdpSocket client = UdpSocket::connected(sink_.local());
    const auto good = numbered(0, 30);
    const std::vector<std::uint8_t> endless(65530);
    for (std::size_t i = 0; i < 41; ++i) batch_.add(i == 20 ? endless : good, nullptr);
    const auto accepted = batch_.send(client.descriptor());
    ASSERT_EQ(accepted.size(), 41U);
    for (std::size_t i = 0; i < 41; ++i) EXPECT_EQ(accepted[i], i != 20) << i;
    EXPECT_EQ(received(sink_).size(), 40U);
}

// The kernel cuts up nothing that it sends without a checksum: then each goes by itself, as on a kernel that cannot cut.
TEST_P(Batches, WhereTheKernelRefusesToCutTheyGoOneByOne) {
    const UdpSocket client = UdpSocket::connected(sink_.local());
    const int on = 1;
    ASSERT_EQ(setsockopt(client.descriptor(), SOL_SOCKET, SO_NO_CHECK, &on, sizeof on), 0);
    const auto bytes = numbered(0, 30);
    for (int round = 0; round < 2; ++round) {
        for (std::size_t i = 0; i < SendBatch::kSize; ++i) batch_.add(bytes, nullptr);
        EXPECT_THAT(batch_.send(client.descriptor()), testing::Each(true));
        EXPECT_EQ(received(sink_).size(), SendBatch::kSize);
    }
}

// Expedited forwarding, which also says that it understands ECN; IPv4, IPv6, and IPv4 at a socket for both.
TEST_P(Batches, TheTrafficClassArrives) {
    if (!has_ipv6()) GTEST_SKIP() << "this machine has no IPv6: sysctl net.ipv6.conf.lo.disable_ipv6=0";
    const auto bytes = numbered(0, 30);
    for (const char* place : {"127.0.0.1:0", "[::1]:0", "[::]:0"}) {
        UdpSocket sink = UdpSocket::listening(read_udp_address(place, ""));
        sink.tell_traffic_class();
        const std::uint16_t port = ntohs(sink.local().port);
        const std::string host = std::string(place) == "[::1]:0" ? "[::1]" : "127.0.0.1";
        const UdpSocket client =
            UdpSocket::connected(read_udp_address(host + ":" + std::to_string(port), ""));
        for (std::size_t i = 0; i < 20; ++i) batch_.add(bytes, nullptr, i < 17 ? 0xb9 : 0, host != "[::1]");
        EXPECT_THAT(batch_.send(client.descriptor()), testing::Each(true)) << place;
        ReceiveBatch in;
        ASSERT_EQ(in.receive(sink.descriptor()), 20U) << place;
        for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(in[i].traffic_class, i < 17 ? 0xb9 : 0) << place << i;
        // And back, to an address.
        const UdpAddress to = in[0].from;
        SendBatch answers(GetParam());
        answers.add(bytes, &to, 0x2e << 2);
        EXPECT_TRUE(answers.send(sink.descriptor())[0]) << place;
    }
}

TEST_P(Batches, AClosedPortIsCounted) {
    const UdpSocket client = [&] {
        const UdpSocket gone = UdpSocket::listening(any_port_here());
        return UdpSocket::connected(gone.local());
    }();
    const auto bytes = numbered(0, 30);
    ReceiveBatch in;
    for (int i = 0; i < 3; ++i) {
        batch_.add(bytes, nullptr);
        batch_.send(client.descriptor());
        EXPECT_EQ(in.receive(client.descriptor()), 0U);
    }
    EXPECT_EQ(batch_.closed_ports() + in.closed_ports(), 3U);
}

INSTANTIATE_TEST_SUITE_P(Joining, Batches, testing::Bool(),
                         [](const auto& mode) { return std::string(mode.param ? "Joined" : "Single"); });

TEST(UdpAddress, ReadsPortAndHost) {
    EXPECT_EQ(to_string(read_udp_address("9000", "--listen")), "0.0.0.0:9000");
    EXPECT_EQ(to_string(read_udp_address("127.0.0.1:65535", "--to")), "127.0.0.1:65535");
}

TEST(UdpAddress, ReadsIpv6InBrackets) {
    for (const char* text : {"[::1]:9000", "[2001:db8::7]:1", "[::]:0"})
        EXPECT_EQ(to_string(read_udp_address(text, "--to")), text);
    EXPECT_TRUE(read_udp_address("[::ffff:10.0.0.1]:1", "--to").is_ipv4());
    EXPECT_FALSE(read_udp_address("[::1]:1", "--to").is_ipv4());
    EXPECT_THAT(refusal([] { read_udp_address("::1:9000", "--to"); }, ExitCode::kUsage),
                testing::HasSubstr("brackets"));
}

TEST(UdpAddress, LooksUpAName) {
    if (!means_this_machine("localhost"))
        GTEST_SKIP() << "localhost has no address here: a line of /etc/hosts";
    EXPECT_EQ(to_string(read_udp_address("localhost:1", "--to")), "127.0.0.1:1");
}

TEST(UdpAddress, RefusesOthersByTheOptionsName) {
    for (const char* text : {"", "host:", "host:65536", "host:-1", "9000x", "a:b", "host: 1"}) {
        EXPECT_THAT(refusal([&] { read_udp_address(text, "--to"); }, ExitCode::kUsage),
                    testing::HasSubstr("--to"))
            << text;
    }
}

}  // namespace
}  // namespace thimble
