// The relay between descriptors that a test holds the other ends of: message sockets behave as TUN devices do.
#include "netem/shell/packet_relay.hpp"

#include <array>
#include <fcntl.h>
#include <optional>
#include <string>
#include <sys/socket.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "common/runtime/wall_clock.hpp"
#include "netem/relay/relay_engine.hpp"
#include "netem/shell/ip_packet.hpp"
#include "tests/unit/netem/shell/sample_packets.hpp"

namespace thimble {
namespace {

class Wire {
  public:
    Wire() { EXPECT_EQ(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, ends_.data()), 0); }
    ~Wire() {
        hang_up();
        close(ends_[0]);
    }
    Wire(const Wire&) = delete;
    Wire& operator=(const Wire&) = delete;

    int relay_end() const { return ends_[0]; }
    void hang_up() {
        if (ends_[1] >= 0) close(ends_[1]);
        ends_[1] = -1;
    }
    void say(const Octets& bytes) {
        EXPECT_EQ(::send(ends_[1], bytes.data(), bytes.size(), 0), std::ssize(bytes));
    }
    std::optional<Octets> hear() {
        Octets bytes(2000);
        const auto size = recv(ends_[1], bytes.data(), bytes.size(), 0);
        if (size < 0) return std::nullopt;
        bytes.resize(static_cast<std::size_t>(size));
        return bytes;
    }

  private:
    std::array<int, 2> ends_{-1, -1};
};

struct PacketRelayTest : testing::Test {
    Wire program, host, slirp, wake;

    PacketRelay relay(const LinkPair& links = {}, const TimelinePair& timelines = {}) {
        return {{.links = links,
                 .timelines = timelines,
                 .inner = {program.relay_end()},
                 .outer = {{host.relay_end(), -1, false, {10, 0, 0, 2}, Octets(16, 0)},
                           {slirp.relay_end(), -1, true}}},
                nullptr,
                wake.relay_end()};
    }
    static void run(PacketRelay& relay) {
        for (int i = 0; i < 3; ++i) relay.step(wall_now() + std::chrono::milliseconds{1});
    }
};

TEST_F(PacketRelayTest, PacketsGoByTheirAddressAndComeBack) {
    PacketRelay under_test = relay();
    const Octets to_host = ip4_packet(kUdp, "hello");
    Octets to_world = to_host;
    to_world[19] = 9;
    program.say(to_host);
    program.say(to_world);
    run(under_test);
    EXPECT_EQ(host.hear(), to_host);
    Octets frame = slirp.hear().value();
    EXPECT_EQ(Octets(frame.begin() + kEthernetBytes, frame.end()), to_world);

    slirp.say(frame);
    host.say(to_host);
    run(under_test);
    EXPECT_TRUE(program.hear());
    EXPECT_TRUE(program.hear());
    EXPECT_FALSE(program.hear());
    const RelayState state = under_test.state(wall_now());
    EXPECT_EQ(state.totals[RelayDirection::kUp].packets.delivered, 2U);
    EXPECT_EQ(state.totals[RelayDirection::kDown].packets.delivered, 2U);
    EXPECT_TRUE(under_test.empty());
}

TEST_F(PacketRelayTest, AStepSaysWhetherAPacketWaited) {
    PacketRelay under_test = relay();
    const auto waited = [&] { return under_test.step(wall_now() + std::chrono::milliseconds{1}); };
    EXPECT_FALSE(waited());
    program.say(ip4_packet(kUdp, "hello"));
    EXPECT_TRUE(waited());
    EXPECT_FALSE(waited());
}

TEST_F(PacketRelayTest, GarbageAndTheKernelsOwnPacketsAreCountedAndHaveNoNumber) {
    PacketRelay under_test = relay();
    program.say(Octets(100, 0xFF));
    program.say({0x45});
    program.say(ip4_packet(2, "12345678"));
    slirp.say(Octets(10, 0));
    slirp.say(Octets(1400, 0));
    program.say(ip4_packet(kUdp, "hello"));
    run(under_test);
    EXPECT_EQ(under_test.ports().garbage, 4U);
    EXPECT_EQ(under_test.ports().local, 1U);
    EXPECT_EQ(under_test.state(wall_now()).totals[RelayDirection::kUp].packets.pushed, 1U);
    EXPECT_TRUE(host.hear());
}

TEST_F(PacketRelayTest, AnEndThatGoesLeavesTheOthers) {
    PacketRelay under_test = relay();
    slirp.hang_up();
    Octets to_world = ip4_packet(kUdp, "hello");
    to_world[19] = 9;
    program.say(to_world);
    program.say(ip4_packet(kUdp, "hello"));
    run(under_test);
    EXPECT_EQ(under_test.ports().ports_closed, 1U);
    EXPECT_EQ(under_test.state(wall_now()).totals[RelayDirection::kUp].refused, 1U);
    EXPECT_TRUE(host.hear());
}

TEST_F(PacketRelayTest, FatesAreThoseOfTheSeed) {
    LinkPair links;
    links.up.loss = LossSettings::independent(0.3);
    PacketRelay under_test = relay(links);
    LinkModel twin(links.up, flow_key(1, 0, 0), kRelayUp);
    for (int i = 0; i < 100; ++i) {
        const Octets packet = ip4_packet(kUdp, std::to_string(i));
        program.say(packet);
        run(under_test);
        twin.push(SessionTime{}, packet);
        EXPECT_EQ(host.hear().has_value(), !twin.pop_due(SessionTime{}).empty()) << i;
    }
}

// A packet that understands ECN is marked instead of lost, and its checksum stays right.
TEST_F(PacketRelayTest, MarksInsteadOfLosing) {
    LinkPair links;
    links.up.loss = LossSettings::independent(1);
    links.up.ecn = true;
    PacketRelay under_test = relay(links);
    Octets v4 = with_checksum(ip4_packet(kUdp, "hello")), v6 = ip6_packet(kUdp, {1, 2, 3});
    program.say(v4);
    v4[1] = 0xBA;
    v6[1] = 0x25;
    program.say(with_checksum(v4));
    program.say(v6);
    run(under_test);
    v4[1] = 0xBB;
    v6[1] = 0x35;
    EXPECT_EQ(host.hear(), with_checksum(v4));
    const Octets frame = slirp.hear().value();
    EXPECT_EQ(Octets(frame.begin() + kEthernetBytes, frame.end()), v6);
    EXPECT_FALSE(host.hear());
    EXPECT_EQ(under_test.state(wall_now()).totals[RelayDirection::kUp].packets.marked, 2U);
}

TEST_F(PacketRelayTest, ShowsTheLinksThatHoldNow) {
    PacketRelay under_test =
        relay({}, {.up = {{Duration{1}, {.delay = std::chrono::milliseconds{40}}}}, .down = {}});
    LinkPair links = under_test.state(wall_now()).links;
    EXPECT_EQ(links.up.delay, std::chrono::milliseconds{40});
    links.up.loss = LossSettings::independent(0.5);
    under_test.change(wall_now(), links);
    EXPECT_EQ(under_test.state(wall_now()).links, links);
}

TEST_F(PacketRelayTest, ChangesHoldFromThenOn) {
    PacketRelay under_test = relay();
    LinkPair links;
    links.up.loss = LossSettings::independent(1);
    under_test.change(wall_now(), links);
    program.say(ip4_packet(kUdp, "hello"));
    run(under_test);
    EXPECT_FALSE(host.hear());
    EXPECT_EQ(under_test.state(wall_now()).totals[RelayDirection::kUp].packets.lost, 1U);
}

}  // namespace
}  // namespace thimble
