// The engine between real sockets, one step at a time, in one thread. Times are checked in one direction only: nothing
// is early; how late depends on the machine.
#include "netem/relay/relay_engine.hpp"

#include <arpa/inet.h>
#include <functional>
#include <netinet/udp.h>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

UdpAddress loopback() { return {htonl(INADDR_LOOPBACK), 0}; }

class Records final : public PacketSink {
  public:
    void add(const PacketRecord& record) override { all.push_back(record); }
    std::vector<PacketRecord> all;
};

class Bench : public testing::Test {
  protected:
    struct Heard {
        std::string words;
        UdpAddress from;
    };

    Bench() : server_(UdpSocket::listening(loopback())) {
        settings_.inlets = {{loopback(), server_.local()}};
        settings_.most_flows = 4;
    }
    void start() { engine_ = std::make_unique<RelayEngine>(settings_, &records_); }
    UdpSocket client() { return UdpSocket::connected(engine_->inlet_address(0)); }
    UdpSocket start_with_client() {
        start();
        return client();
    }

    static void say(const UdpSocket& socket, const std::string& words, const UdpAddress* to = nullptr) {
        SendBatch batch;
        batch.add({reinterpret_cast<const std::uint8_t*>(words.data()), words.size()}, to);
        ASSERT_TRUE(batch.send(socket.descriptor())[0]);
    }
    // Lets the relay work until `done`; false if a minute passed first.
    bool step_until(const std::function<bool()>& done) {
        for (const SessionTime end = wall_now() + seconds{60}; !done() && wall_now() < end;)
            engine_->step(wall_now() + milliseconds{1});
        return done();
    }
    // Takes in so many, and waits until all are due at once.
    void take_in(std::uint64_t packets) {
        EXPECT_TRUE(step_until(
            [&] { return engine_->totals(wall_now())[RelayDirection::kUp].packets.pushed >= packets; }));
        wall_sleep(settings_.links.up.delay + milliseconds{10});
    }
    // Lets the relay work until `socket` has heard so many, or patience ends.
    std::vector<Heard> hear(const UdpSocket& socket, std::size_t count, Duration patience = seconds{10}) {
        std::vector<Heard> heard;
        ReceiveBatch batch;
        for (const SessionTime end = wall_now() + patience; heard.size() < count && wall_now() < end;) {
            engine_->step(wall_now() + milliseconds{2});
            const std::size_t found = batch.receive(socket.descriptor());
            for (std::size_t i = 0; i < found; ++i) {
                const auto datagram = batch[i];
                heard.push_back({std::string(datagram.bytes.begin(), datagram.bytes.end()), datagram.from});
            }
        }
        return heard;
    }

    UdpSocket server_;
    RelaySettings settings_;
    Records records_;
    std::unique_ptr<RelayEngine> engine_;
};

TEST_F(Bench, GivesEachClientAWayAndItsOwnWayBack) {
    const UdpSocket a = start_with_client(), b = client();
    say(a, "from a");
    say(b, "from b");
    const auto heard = hear(server_, 2);
    ASSERT_EQ(heard.size(), 2U);
    EXPECT_NE(heard[0].from.port, heard[1].from.port);
    for (const Heard& h : heard) say(server_, "to" + h.words.substr(4), &h.from);
    EXPECT_EQ(hear(a, 1).at(0).words, "to a");
    EXPECT_EQ(hear(b, 1).at(0).words, "to b");
    EXPECT_EQ(engine_->totals(wall_now()).flows_opened, 2U);
}

TEST_F(Bench, DelaysEachDirectionByItself) {
    settings_.links.up.delay = milliseconds{30};
    settings_.links.down.delay = milliseconds{5};
    const UdpSocket a = start_with_client();
    const SessionTime begin = wall_now();
    say(a, "x");
    const auto heard = hear(server_, 1);
    ASSERT_EQ(heard.size(), 1U);
    const SessionTime there = wall_now();
    EXPECT_GE(there - begin, milliseconds{30});
    say(server_, "y", &heard[0].from);
    ASSERT_EQ(hear(a, 1).size(), 1U);
    EXPECT_GE(wall_now() - there, milliseconds{5});
    for (const PacketRecord& r : records_.all) EXPECT_GE(r.sent_ns, r.due_ns);
    EXPECT_EQ(records_.all.at(0).due_ns - records_.all.at(0).received_ns, 30'000'000);
    EXPECT_EQ(records_.all.at(1).due_ns - records_.all.at(1).received_ns, 5'000'000);
    EXPECT_EQ(records_.all.at(1).direction, RelayDirection::kDown);
}

// Of the relay the next slot opens in a minute.
TEST_F(Bench, SlotsBeginWithTheirClient) {
    settings_.links.up.slot = settings_.links.down.slot = {.least = seconds{60}, .most = seconds{60}};
    start();
    wall_sleep(milliseconds{5});
    const UdpSocket a = client();
    say(a, "x");
    ASSERT_EQ(hear(server_, 1).size(), 1U);
    EXPECT_EQ(records_.all.at(0).due_ns, records_.all.at(0).received_ns);
}

// The log holds arrival time and size of the packet that head drop removes, not of the one that came then.
TEST_F(Bench, LogsWhenADroppedPacketCame) {
    settings_.links.up.rate = {.bits_per_s = 40, .queue_packets = 1, .drop = Drop::kHead};
    const UdpSocket a = start_with_client();
    for (const char* word : {"0", "1", "22"}) say(a, word);
    ASSERT_EQ(hear(server_, 2).size(), 2U);
    ASSERT_EQ(records_.all.size(), 3U);
    const PacketRecord& dropped = records_.all[0];
    EXPECT_EQ(dropped.packet, 1U);
    EXPECT_EQ(dropped.fate, LoggedFate::kQueueFull);
    EXPECT_EQ(dropped.bytes, 1U);
    EXPECT_GT(dropped.received_ns, records_.all[1].received_ns);
    EXPECT_LT(dropped.received_ns, records_.all[2].received_ns);
}

TEST_F(Bench, NothingLeavesEarlyAlsoWhenItSpins) {
    settings_.precise = true;
    settings_.links.up.delay = milliseconds{2};
    settings_.links.up.jitter = {JitterShape::kUniform, milliseconds{2}};
    const UdpSocket a = start_with_client();
    for (int i = 0; i < 200; ++i) {
        say(a, "x");
        engine_->step(wall_now());
    }
    EXPECT_EQ(hear(server_, 200).size(), 200U);
    EXPECT_EQ(records_.all.size(), 200U);
    for (const PacketRecord& r : records_.all) {
        EXPECT_GE(r.sent_ns, r.due_ns);
        EXPECT_GE(r.due_ns, r.received_ns);
    }
}

TEST_F(Bench, KeepsTheOrder) {
    settings_.links.up.delay = milliseconds{10};
    settings_.links.up.jitter = {JitterShape::kUniform, milliseconds{10}};
    const UdpSocket a = start_with_client();
    const std::string sent = "abcdefghijklmnopqrstuvwxyz";
    for (const char c : sent) say(a, std::string(1, c));
    std::string got;
    for (const Heard& h : hear(server_, 26)) got += h.words;
    EXPECT_EQ(got, sent);
}

TEST_F(Bench, CarriesTheLongestDatagram) {
    const UdpSocket a = start_with_client();
    const std::string longest(kLargestDatagramBytes, 'w');
    say(a, longest);
    EXPECT_EQ(hear(server_, 1).at(0).words, longest);
}

TEST_F(Bench, LosesWhatItsSeedSays) {
    settings_.links.up.loss = LossSettings::independent(0.5);
    settings_.seed = 7;
    const UdpSocket a = start_with_client();
    for (int i = 0; i < 100; ++i) say(a, "x");
    EXPECT_TRUE(step_until([&] { return records_.all.size() >= 100; }));
    LinkModel model(settings_.links.up, flow_key(7, 0, 0), kRelayUp);
    for (int i = 0; i < 100; ++i)
        model.push(SessionTime{}, Bytes{reinterpret_cast<const std::uint8_t*>("x"), 1});
    std::uint64_t lost = 0;
    for (const PacketRecord& r : records_.all) lost += r.fate == LoggedFate::kLost ? 1 : 0;
    EXPECT_EQ(records_.all.size(), 100U);
    EXPECT_EQ(lost, model.counters().lost);
    EXPECT_GT(lost, 20U);
}

TEST_F(Bench, ForgetsTheSilentAndTakesOthersInstead) {
    settings_.most_flows = 1;
    settings_.idle = seconds{2};
    const UdpSocket a = start_with_client(), b = client();
    say(a, "a");
    ASSERT_EQ(hear(server_, 1).size(), 1U);
    say(b, "b");
    EXPECT_TRUE(step_until([&] { return engine_->totals(wall_now()).flows_refused == 1; }));
    EXPECT_EQ(hear(server_, 1, milliseconds{20}).size(), 0U);
    EXPECT_TRUE(step_until([&] { return engine_->totals(wall_now()).flows == 0; }));
    say(b, "b");
    EXPECT_EQ(hear(server_, 1).size(), 1U);
    EXPECT_EQ(engine_->totals(wall_now())[RelayDirection::kUp].packets.pushed, 2U)
        << "also those of closed flows";
}

TEST_F(Bench, DoesNotForgetWhoHasPacketsInFlight) {
    settings_.idle = milliseconds{50};
    settings_.links.up.delay = milliseconds{600};
    const UdpSocket a = start_with_client();
    say(a, "a");
    EXPECT_EQ(hear(server_, 1).size(), 1U);
}

TEST_F(Bench, ChangesLinksWhileItRuns) {
    const UdpSocket a = start_with_client();
    say(a, "first");
    ASSERT_EQ(hear(server_, 1).size(), 1U);
    LinkPair links;
    links.up.delay = milliseconds{40};
    engine_->change(wall_now(), links);
    const SessionTime begin = wall_now();
    say(a, "second");
    ASSERT_EQ(hear(server_, 1).size(), 1U);
    EXPECT_GE(wall_now() - begin, milliseconds{40});
}

TEST_F(Bench, ShowsTheLinksThatHoldNow) {
    settings_.timelines.up = {{Duration{1}, {.delay = milliseconds{40}}}};
    start();
    LinkPair links = engine_->state(wall_now()).links;
    EXPECT_EQ(links.up.delay, milliseconds{40});
    links.up.loss = LossSettings::independent(0.5);
    engine_->change(wall_now(), links);
    EXPECT_EQ(engine_->state(wall_now()).links, links);
}

// Through inlets of all kinds, and "congestion experienced" for what would be lost.
TEST_F(Bench, CarriesDscpAndEcn) {
    settings_.links.up.loss = LossSettings::independent(1);
    settings_.links.up.ecn = true;
    server_.tell_traffic_class();
    const UdpSocket a = start_with_client();
    SendBatch batch;
    const std::uint8_t byte = 7;
    batch.add({&byte, 1}, nullptr, 0xba);
    ASSERT_TRUE(batch.send(a.descriptor())[0]);
    ReceiveBatch in;
    for (const SessionTime end = wall_now() + seconds{10};
         wall_now() < end && in.receive(server_.descriptor()) == 0;)
        engine_->step(wall_now() + milliseconds{2});
    EXPECT_EQ(in[0].traffic_class, 0xbb);
    EXPECT_EQ(engine_->totals(wall_now())[RelayDirection::kUp].packets.marked, 1U);
}

TEST_F(Bench, RelaysIpv6) {
    UdpSocket server;
    try {
        server = UdpSocket::listening(read_udp_address("[::1]:0", ""));
    } catch (const Error&) {
        GTEST_SKIP() << "this machine has no IPv6: sysctl net.ipv6.conf.lo.disable_ipv6=0";
    }
    settings_.inlets = {{UdpAddress::all(0), server.local()}};
    start();
    const std::string port = std::to_string(ntohs(engine_->inlet_address(0).port));
    for (const char* host : {"127.0.0.1:", "[::1]:"}) {
        const UdpSocket a = UdpSocket::connected(read_udp_address(host + port, ""));
        say(a, "there");
        const auto heard = hear(server, 1);
        ASSERT_EQ(heard.size(), 1U) << host;
        say(server, "back", &heard[0].from);
        EXPECT_EQ(hear(a, 1).at(0).words, "back") << host;
    }
}

TEST_F(Bench, CountsAnswersThatAPortIsClosed) {
    {
        const UdpSocket gone = UdpSocket::listening(loopback());
        settings_.inlets = {{loopback(), gone.local()}};
    }
    const UdpSocket a = start_with_client();
    say(a, "x");
    EXPECT_TRUE(step_until([&] { return engine_->totals(wall_now()).closed_ports.at(0) > 0; }));
    EXPECT_EQ(engine_->totals(wall_now()).closed_ports, std::vector<std::uint64_t>{1});
}

// A receiver that takes pieces as they are (UDP_GRO) gets each datagram for itself.
TEST_F(Bench, JoinsNothingAtALowRate) {
    settings_.links.up.delay = milliseconds{20};
    const int on = 1;
    ASSERT_EQ(setsockopt(server_.descriptor(), SOL_UDP, UDP_GRO, &on, sizeof on), 0);
    const UdpSocket a = start_with_client();
    for (int i = 0; i < 40; ++i) say(a, "x");
    take_in(40);
    const std::vector<Heard> all = hear(server_, 40);
    EXPECT_EQ(all.size(), 40U);
    for (const Heard& heard : all) EXPECT_EQ(heard.words, "x");
}

TEST_F(Bench, HasSeveralInlets) {
    const UdpSocket other = UdpSocket::listening(loopback());
    settings_.inlets.push_back({loopback(), other.local()});
    start();
    const UdpSocket a = client(), b = UdpSocket::connected(engine_->inlet_address(1));
    say(a, "one");
    say(b, "two");
    EXPECT_EQ(hear(server_, 1).at(0).words, "one");
    EXPECT_EQ(hear(other, 1).at(0).words, "two");
}

// Two packets of the modest flow wait no longer than a turn of the greedy one.
TEST_F(Bench, LetsNoFlowWaitForAGreedyOne) {
    settings_.links.up.delay = milliseconds{50};
    const UdpSocket greedy = start_with_client(), modest = client();
    for (int i = 0; i < 500; ++i) say(greedy, "g");
    say(modest, "m");
    take_in(501);
    const std::size_t before = records_.all.size();
    hear(server_, 501);
    std::size_t place = before;
    while (place < records_.all.size() && records_.all[place].flow != 1) ++place;
    EXPECT_LT(place, records_.all.size());
    EXPECT_LE(place, before + 16) << "one turn";
}

}  // namespace
}  // namespace thimble
