// Datagrams over the loopback interface. Order and counters only: nothing here measures time.
#include "common/runtime/udp_channel.hpp"

#include <cstring>
#include <netinet/in.h>
#include <poll.h>
#include <string>
#include <sys/socket.h>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/runtime/sockets.hpp"
#include "common/runtime/wall_clock.hpp"
#include "tests/refusal.hpp"
#include "tests/unit/common/packet.hpp"

namespace thimble {
namespace {

using testing::AllOf;
using testing::HasSubstr;
constexpr const char* kHere = "127.0.0.1";

// Any free port, so that tests can run side by side.
std::uint16_t port_of(const UdpChannel& channel) {
    sockaddr_in address{};
    socklen_t length = sizeof address;
    getsockname(channel.file_descriptor(), static_cast<sockaddr*>(static_cast<void*>(&address)), &length);
    return ntohs(address.sin_port);
}

bool wait_for_datagram(const UdpChannel& channel) {
    pollfd waiting{channel.file_descriptor(), POLLIN, 0};
    return poll(&waiting, 1, 5000) == 1;
}

class UdpPair : public testing::Test {
  protected:
    UdpChannel receiver{Endpoint{kHere, 0}, Endpoint{kHere, 0}};
    UdpChannel sender{std::nullopt, Endpoint{kHere, port_of(receiver)}};
    int early = 0;
};

TEST_F(UdpPair, SendsAndReceivesInOrder) {
    sender.send(Packet{1, 2, 3});
    sender.send(Packet(kMaxDatagramBytes, 4));
    ASSERT_TRUE(wait_for_datagram(receiver));
    EXPECT_EQ(copy(receiver.receive()), (Packet{1, 2, 3}));
    ASSERT_TRUE(wait_for_datagram(receiver));
    EXPECT_EQ(copy(receiver.receive()), Packet(kMaxDatagramBytes, 4));
    EXPECT_TRUE(receiver.receive().empty());
    EXPECT_EQ(sender.counters().sent, 2U);
    EXPECT_EQ(receiver.counters().received, 2U);
}

TEST_F(UdpPair, ArrivalsAreStampedOnceAsked) {
    sender.send(Packet{1});
    ASSERT_TRUE(wait_for_datagram(receiver));
    receiver.receive();
    EXPECT_FALSE(receiver.arrival());
    receiver.stamp_arrivals();
    for (int i = 0; i < 100; ++i) {
        const SessionTime before = wall_now();
        sender.send(Packet{2});
        ASSERT_TRUE(wait_for_datagram(receiver));
        wall_sleep(std::chrono::microseconds{200});
        const SessionTime asked = wall_now();
        ASSERT_FALSE(receiver.receive().empty());
        ASSERT_TRUE(receiver.arrival());
        EXPECT_GE(*receiver.arrival(), before);
        EXPECT_LE(*receiver.arrival(), wall_now());
        early += *receiver.arrival() < asked ? 1 : 0;
    }
    EXPECT_GT(early, 0);  // the kernel's stamp, not the moment of the call
}

TEST_F(UdpPair, TooLongIsCountedAndEmptyIsNotTheEndOfTheQueue) {
    sender.send(Packet(kMaxDatagramBytes + 1, 1));
    sender.send({});
    sender.send(Packet(5000, 1));
    sender.send(Packet{9});
    ASSERT_TRUE(wait_for_datagram(receiver));
    EXPECT_EQ(copy(receiver.receive()), (Packet{9}));
    EXPECT_EQ(receiver.counters().too_long, 2U);
    EXPECT_EQ(receiver.counters().received, 1U);
}

TEST(UdpChannel, AForeignSourceIsCountedAndSkipped) {
    UdpChannel receiver(Endpoint{kHere, 0}, Endpoint{"127.0.0.2", 0});  // listens to .2 only
    const Endpoint target{kHere, port_of(receiver)};
    UdpChannel stranger(Endpoint{"127.0.0.3", 0}, target);
    UdpChannel peer(Endpoint{"127.0.0.2", 0}, target);
    stranger.send(Packet{6});
    peer.send(Packet{7});
    ASSERT_TRUE(wait_for_datagram(receiver));
    EXPECT_EQ(copy(receiver.receive()), (Packet{7}));
    EXPECT_TRUE(receiver.receive().empty());
    EXPECT_EQ(receiver.counters().foreign_source, 1U);
    EXPECT_EQ(receiver.counters().received, 1U);
}

// Each direction of a control channel is the same socket.
TEST(UdpChannel, BothWays) {
    UdpChannel a(Endpoint{kHere, 0}, Endpoint{kHere, 0});
    UdpChannel b(Endpoint{kHere, 0}, Endpoint{kHere, port_of(a)});
    b.send(Packet{1});
    ASSERT_TRUE(wait_for_datagram(a));
    EXPECT_EQ(copy(a.receive()), (Packet{1}));
    UdpChannel answer(std::nullopt, Endpoint{kHere, port_of(b)});
    answer.send(Packet{2});
    ASSERT_TRUE(wait_for_datagram(b));
    EXPECT_EQ(copy(b.receive()), (Packet{2}));
}

TEST(UdpChannel, APortInUseAndAHostThatIsNotOursOrNoneAreNamed) {
    const UdpChannel first(Endpoint{kHere, 0}, Endpoint{kHere, 1});
    const std::string port = std::to_string(port_of(first));
    const std::string impossible(300, 'x');  // longer than a name can be: no name server is asked
    struct Case {
        std::optional<Endpoint> local;
        Endpoint remote;
        std::string place, advice;
    };
    for (const Case& one :
         {Case{Endpoint{kHere, port_of(first)}, {kHere, 1}, "127.0.0.1:" + port, "base_port"},
          Case{Endpoint{"192.0.2.1", 0}, {kHere, 1}, "192.0.2.1", "[network]"},  // TEST-NET-1
          Case{std::nullopt, {impossible, 1}, impossible, "[network]"}}) {
        EXPECT_THAT(refusal([&] { UdpChannel(one.local, one.remote); }, ExitCode::kNetwork),
                    AllOf(HasSubstr(one.place), HasSubstr(one.advice)));
    }
}

TEST(UdpChannel, SendingToNobodyNeverThrowsNorBlocksReceiving) {
    UdpChannel channel(Endpoint{kHere, 0}, Endpoint{kHere, 9});
    for (int i = 0; i < 100; ++i) {
        channel.send(Packet{1});
        EXPECT_TRUE(channel.receive().empty());
    }
    EXPECT_EQ(channel.counters().sent + channel.counters().send_failed, 100U);
}

TEST(Sockets, SumsTheCountersAndWatchesWhatListens) {
    NetworkSettings settings;
    UdpChannel probe(Endpoint{kHere, 0}, Endpoint{kHere, 1});
    settings.base_port = port_of(probe);  // outlets only: nothing is bound there
    Sockets sockets(settings);
    Channel* a = sockets.outlet(Port::kSlaveNeedle);
    Channel* b = sockets.outlet(Port::kMasterForce);
    a->send(Packet{1});
    b->send(Packet{1});
    EXPECT_TRUE(sockets.listeners().empty());
    EXPECT_EQ(sockets.counters().sent + sockets.counters().send_failed, 2U);
}

}  // namespace
}  // namespace thimble
