// Datagrams and bytes over the loopback interface. Order and counters only: nothing here measures time.
#include <array>
#include <cstring>
#include <poll.h>
#include <string>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/queue_channel.hpp"
#include "common/runtime/sockets.hpp"
#include "common/runtime/tcp_client.hpp"
#include "common/runtime/wall_clock.hpp"
#include "tests/allocation_count.hpp"
#include "tests/refusal.hpp"
#include "tests/unit/common/packet.hpp"

namespace thimble {
namespace {

using testing::AllOf;
using testing::HasSubstr;
constexpr const char* kHere = "127.0.0.1";

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

// As Debian names a machine to itself: the kernel lets an unbound socket send from 127.0.0.1.
TEST(UdpChannel, AHostOfTheLoopbackNetIsHeardFromASocketThatIsBoundToNone) {
    for (const bool also : {false, true}) {
        UdpChannel receiver(Endpoint{"127.0.1.1", 0}, Endpoint{also ? "192.0.2.1" : "127.0.1.1", 0});
        if (also) receiver.listen_also_to({"127.0.1.1"});
        UdpChannel sender(std::nullopt, Endpoint{"127.0.1.1", port_of(receiver)});
        sender.send(Packet{8});
        ASSERT_TRUE(wait_for_datagram(receiver));
        EXPECT_EQ(copy(receiver.receive()), (Packet{8})) << also;
    }
}

// In lock-step its programs send from the ports that they listen at. At 127.0.0.1 these may be another user's.
TEST(UdpChannel, InLockStepAHostOfTheLoopbackNetIsHeardFromItselfAlone) {
    for (const bool itself : {false, true}) {
        const std::string host = itself ? kHere : "127.0.1.1";
        UdpChannel receiver(Endpoint{host, 0}, Endpoint{host, 0});
        UdpChannel sender(Endpoint{kHere, 0}, Endpoint{host, port_of(receiver)});
        const auto base = static_cast<std::uint16_t>(port_of(sender) - static_cast<int>(Port::kNetemControl));
        receiver.await_announced(Port::kSlaveNeedle, base, std::chrono::milliseconds{100});
        receiver.announce(1);
        sender.send(Packet{8});
        if (itself) {
            EXPECT_EQ(copy(receiver.receive()), (Packet{8}));
        } else {
            EXPECT_THROW(receiver.receive(), DatagramLost);
        }
        EXPECT_EQ(receiver.counters().foreign_source, itself ? 0U : 1U);
    }
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
    settings.security.mode = SecurityMode::kNone;
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

// Messages of one pool and datagrams, in the order of sending.
TEST(QueueChannel, HandsOverWhatIsSharedAndMakesBytesForWhoAsks) {
    MessagePool pool;
    QueueChannel a, b;
    a.connect(b);
    a.share(pool);
    b.share(pool);
    SharedMessage& first = pool.take();
    first.message = {Header{1, {}, 2, 3, Role::kMaster}, NeedleCommand{1, 2, 3, 4, 5, 6}};
    a.hand_over(first);
    a.send(Packet{7});
    a.hand_over(first);
    pool.release(first);
    EXPECT_EQ(first.users, 2U);
    EXPECT_EQ(b.receive_shared(), &first);
    EXPECT_EQ(b.receive_shared(), nullptr);
    EXPECT_EQ(copy(b.receive()), (Packet{7}));
    EXPECT_EQ(first.users, 1U);
    Encoder encoder;
    EXPECT_EQ(copy(b.receive()), copy(encoder.encode(first.message)));
    EXPECT_TRUE(b.receive().empty());
    EXPECT_EQ(b.receive_shared(), nullptr);
}

TEST(QueueChannel, AMessageIsKeptUntilTheNextCallAndThenUsedAgain) {
    MessagePool pool;
    QueueChannel a, b;
    a.connect(b);
    for (QueueChannel* end : {&a, &b}) end->share(pool);
    const SharedMessage* last = nullptr;
    for (std::uint32_t i = 0; i < 1000; ++i) {
        SharedMessage& sent = pool.take();
        EXPECT_NE(&sent, last) << "its reader may still look at it";
        sent.message = {Header{1, {}, i, 0, Role::kMaster}, Percept{}};
        a.hand_over(sent);
        pool.release(sent);
        last = b.receive_shared();
        ASSERT_NE(last, nullptr);
        EXPECT_EQ(last->message.header.sequence, i);
    }
    EXPECT_EQ(pool.size(), 64U);
}

// A program that listens on a port that the kernel has chosen.
class Tcp : public testing::Test {
  protected:
    void SetUp() override {
        sockaddr_in here{};
        here.sin_family = AF_INET;
        here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof here;
        ASSERT_EQ(bind(listening_, reinterpret_cast<const sockaddr*>(&here), size), 0);
        ASSERT_EQ(listen(listening_, 1), 0);
        ASSERT_EQ(getsockname(listening_, reinterpret_cast<sockaddr*>(&here), &size), 0);
        port_ = ntohs(here.sin_port);
    }
    void TearDown() override { close(listening_); }
    // The client's words after the other side has closed with these bytes unread.
    std::string why_closed(std::string_view unread) const {
        TcpClient client({kHere, port_}, "");
        client.connect();
        const int accepted = accept(listening_, nullptr, nullptr);
        EXPECT_EQ(client.state(), ByteStream::State::kOpen);
        EXPECT_EQ(client.send(unread), unread.size());
        close(accepted);
        std::array<char, 8> room{};
        for (int i = 0; i < 5000 && client.state() == ByteStream::State::kOpen; ++i) {
            EXPECT_EQ(client.receive(room), 0U);
            wall_sleep(std::chrono::milliseconds{1});
        }
        return std::string(client.why());
    }

  private:
    int listening_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    std::uint16_t port_ = 0;
};

TEST_F(Tcp, AClientSaysThatTheOtherSideClosedWhateverWasUnread) {
    EXPECT_EQ(why_closed(""), "the other side closed it");
    EXPECT_EQ(why_closed("not read"), "the other side closed it");
}

TEST(QueueChannel, AMessageForWhichThereIsNoRoomIsLostAndCounted) {
    MessagePool pool;
    QueueChannel a, b(2);
    a.connect(b);
    for (QueueChannel* end : {&a, &b}) end->share(pool);
    SharedMessage& sent = pool.take();
    for (int i = 0; i < 3; ++i) a.hand_over(sent);
    EXPECT_EQ(b.lost(), 2U);
    EXPECT_EQ(sent.users, 2U);
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
