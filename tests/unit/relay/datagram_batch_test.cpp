#include "netem/relay/datagram_batch.hpp"

#include <arpa/inet.h>
#include <poll.h>
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

// Waits until there is a datagram, or an answer that a port is closed: the kernel may deliver later than a send returns.
bool has_something(const UdpSocket& socket) {
    pollfd wanted{socket.descriptor(), POLLIN, 0};
    return poll(&wanted, 1, 10'000) > 0;
}

class Batches : public testing::TestWithParam<bool> {
  protected:
    // Sends datagrams of these sizes. The sink gets the same, in the same order.
    void expect_through(const std::vector<std::size_t>& sizes) {
        std::vector<std::vector<std::uint8_t>> sent;
        sent.reserve(sizes.size());
        for (const std::size_t size : sizes) sent.push_back(numbered(sent.size(), size));
        const UdpSocket client = UdpSocket::connected(sink_.local());
        for (const auto& datagram : sent) batch_.add(datagram, nullptr);
        EXPECT_THAT(batch_.send(client.descriptor()), testing::Each(true));
        EXPECT_EQ(batch_.size(), 0U);
        EXPECT_EQ(received(sink_, sizes.size()), sent);
    }
    // Hands on what comes until there are so many, and what else has come by then.
    template <typename Take>
    static void receive(const UdpSocket& sink, std::size_t expected, const Take& take) {
        ReceiveBatch in;
        for (std::size_t taken = 0, count = 1; count > 0 || (taken < expected && has_something(sink));) {
            count = in.receive(sink.descriptor());
            for (std::size_t i = 0; i < count; ++i) take(in[i]);
            taken += count;
        }
    }
    static std::vector<std::vector<std::uint8_t>> received(const UdpSocket& sink, std::size_t expected) {
        std::vector<std::vector<std::uint8_t>> all;
        receive(sink, expected, [&](const ReceiveBatch::Datagram& datagram) {
            all.emplace_back(datagram.bytes.begin(), datagram.bytes.end());
        });
        return all;
    }
    // Sends expedited forwarding, which also says that it understands ECN, to `host` at a socket of `place`.
    void expect_traffic_class(const std::string& host, const std::string& place) {
        UdpSocket sink = UdpSocket::listening(read_udp_address(place + ":0", ""));
        sink.tell_traffic_class();
        const std::string port = std::to_string(ntohs(sink.local().port));
        const UdpSocket client = UdpSocket::connected(read_udp_address(host + ":" + port, ""));
        const auto bytes = numbered(0, 30);
        for (std::size_t i = 0; i < 20; ++i) batch_.add(bytes, nullptr, i < 17 ? 0xb9 : 0, host != "[::1]");
        EXPECT_THAT(batch_.send(client.descriptor()), testing::Each(true)) << place;
        std::vector<int> classes, expected(17, 0xb9);
        expected.resize(20, 0);
        UdpAddress to;
        receive(sink, 20, [&](const ReceiveBatch::Datagram& datagram) {
            classes.push_back(datagram.traffic_class);
            to = datagram.from;
        });
        EXPECT_EQ(classes, expected) << place;
        // And back, to an address.
        SendBatch answers(GetParam());
        answers.add(bytes, &to, 0x2e << 2);
        EXPECT_TRUE(answers.send(sink.descriptor())[0]) << place;
    }

    UdpSocket sink_ = UdpSocket::listening(any_port_here());
    SendBatch batch_{GetParam()};
};

TEST_P(Batches, OneSizeArrivesAsItWasSent) {
    expect_through(std::vector<std::size_t>(SendBatch::kSize, 144));
}

TEST_P(Batches, RunsOfSeveralSizesKeepTheirOrder) {
    std::vector<std::size_t> sizes(20, 100);
    sizes.insert(sizes.end(), 3, 50);
    sizes.insert(sizes.end(), 17, 101);
    sizes.push_back(1);
    sizes.insert(sizes.end(), 16, SendBatch::kLongestJoined);
    expect_through(sizes);
}

TEST_P(Batches, LongOnesStaySingle) { expect_through(std::vector<std::size_t>(18, 9000)); }

TEST_P(Batches, EveryReceiverGetsItsOwn) {
    const UdpSocket other = UdpSocket::listening(any_port_here()),
                    client = UdpSocket::listening(any_port_here());
    const UdpAddress here = sink_.local(), there = other.local();
    const auto bytes = numbered(0, 30);
    for (std::size_t i = 0; i < 40; ++i) batch_.add(bytes, i < 23 ? &here : &there);
    EXPECT_THAT(batch_.send(client.descriptor()), testing::Each(true));
    EXPECT_EQ(received(sink_, 23).size(), 23U);
    EXPECT_EQ(received(other, 17).size(), 17U);
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
    EXPECT_EQ(received(sink_, 40).size(), 40U);
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
        EXPECT_EQ(received(sink_, SendBatch::kSize).size(), SendBatch::kSize);
    }
}

TEST_P(Batches, TheTrafficClassArrives) { expect_traffic_class("127.0.0.1", "127.0.0.1"); }

// By IPv6, and by IPv4 at a socket for both.
TEST_P(Batches, TheTrafficClassArrivesByIpv6) {
    if (!has_ipv6()) GTEST_SKIP() << "this machine has no IPv6: sysctl net.ipv6.conf.lo.disable_ipv6=0";
    expect_traffic_class("[::1]", "[::1]");
    expect_traffic_class("127.0.0.1", "[::]");
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
        EXPECT_TRUE(has_something(client));
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
    EXPECT_EQ(to_string(read_udp_address("[::ffff:10.0.0.1]:1", "--to")), "10.0.0.1:1");
    EXPECT_FALSE(read_udp_address("[::1]:1", "--to").is_ipv4());
    EXPECT_THAT(refusal([] { read_udp_address("::1:9000", "--to"); }, ExitCode::kUsage),
                testing::HasSubstr("brackets"));
    EXPECT_THAT(refusal([] { read_udp_address("[::1]", "--listen"); }, ExitCode::kUsage),
                testing::HasSubstr("[IPv6]:PORT"));
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
