// The far side can do no harm: who gets an answer, of what length, and how often.
#include "thimble/link_test/echo_responder.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::uint32_t kHere = 0x0100007f, kElsewhere = 0x0200000a;
constexpr std::uint64_t kNonce = 0xabcdef;
constexpr std::uint16_t kPort = 14;

class EchoResponderTest : public testing::Test {
  protected:
    // The answer, if there is one.
    std::optional<ProbePacket> ask(ProbeKind kind, std::uint64_t nonce, std::uint32_t sequence = 1,
                                   std::uint32_t host = kHere, std::uint16_t port = kPort,
                                   std::size_t bytes = 104) {
        ProbePacket request;
        request.kind = kind;
        request.port = kPort;
        request.nonce = nonce;
        request.sequence = sequence;
        request.probe_sent = from_nanoseconds(77);
        std::vector<std::uint8_t> datagram(bytes);
        write_probe(request, datagram);
        const auto before = datagram;
        const bool answered = responder.answer(now, now - Duration{5}, host, port, datagram);
        EXPECT_EQ(datagram.size(), bytes);
        if (answered) return read_probe(datagram);
        EXPECT_EQ(datagram, before);
        return std::nullopt;
    }

    EchoLimits limits;
    std::uint64_t drawn = kNonce;
    EchoResponder responder{limits, [this] { return drawn++; }};
    SessionTime now{seconds{100}};
};

TEST_F(EchoResponderTest, WelcomesAndEchoes) {
    const auto welcome = ask(ProbeKind::kHello, 4242);
    ASSERT_TRUE(welcome);
    EXPECT_EQ(welcome->kind, ProbeKind::kWelcome);
    EXPECT_EQ(welcome->nonce, kNonce);
    ask(ProbeKind::kProbe, kNonce, 1);
    ask(ProbeKind::kProbe, kNonce, 3);
    ask(ProbeKind::kProbe, kNonce, 2);
    const auto echo = ask(ProbeKind::kProbe, kNonce, 2);
    ASSERT_TRUE(echo);
    EXPECT_EQ(echo->kind, ProbeKind::kEcho);
    EXPECT_EQ(echo->far_received, 3U);
    EXPECT_EQ(echo->far_duplicates, 1U);
    EXPECT_EQ(echo->far_reordered, 1U);
    EXPECT_EQ(echo->far_sent, 4U);
    EXPECT_EQ(echo->probe_sent, from_nanoseconds(77));
    EXPECT_EQ(echo->probe_arrived, now - Duration{5});
    EXPECT_EQ(echo->echo_sent, now);
    const auto counts = ask(ProbeKind::kQuery, kNonce, 9);
    ASSERT_TRUE(counts);
    EXPECT_EQ(counts->kind, ProbeKind::kCounts);
    EXPECT_EQ(counts->far_received, 3U);  // a query is no probe
}

TEST_F(EchoResponderTest, NeverMoreBytesOutThanIn) {
    ask(ProbeKind::kHello, 1);
    for (const std::size_t bytes :
         {kProbeHeaderBytes, std::size_t{144}, std::size_t{9000}, kLargestProbeBytes}) {
        EXPECT_TRUE(ask(ProbeKind::kQuery, kNonce, 1, kHere, kPort, bytes))
            << bytes;  // ask() compares lengths
    }
}

TEST_F(EchoResponderTest, WithoutItsNonceNobodyGetsAnEcho) {
    EXPECT_FALSE(ask(ProbeKind::kProbe, kNonce));  // no hello yet
    ask(ProbeKind::kHello, 1);
    EXPECT_FALSE(ask(ProbeKind::kProbe, kNonce + 1));
    EXPECT_FALSE(ask(ProbeKind::kProbe, kNonce, 1, kElsewhere));  // the nonce of another host
    EXPECT_EQ(responder.counters().wrong_nonce, 3U);
    EXPECT_TRUE(ask(ProbeKind::kProbe, kNonce));
}

TEST_F(EchoResponderTest, AnswersNoAnswersAndNoStrangers) {
    ask(ProbeKind::kHello, 1);
    for (const ProbeKind kind : {ProbeKind::kWelcome, ProbeKind::kEcho, ProbeKind::kCounts})
        EXPECT_FALSE(ask(kind, kNonce));  // two echoes would talk for ever
    std::vector<std::uint8_t> noise(104, 0x55), nothing;
    EXPECT_FALSE(responder.answer(now, now, kHere, kPort, noise));
    EXPECT_FALSE(responder.answer(now, now, kHere, kPort, nothing));
    EXPECT_EQ(responder.counters().malformed, 5U);
    EXPECT_FALSE(ask(ProbeKind::kProbe, kNonce, 1, kHere, kPort + 1));
    EXPECT_FALSE(ask(ProbeKind::kProbe, kNonce, 1, kHere, 999));
    EXPECT_EQ(responder.counters().wrong_port, 2U);
}

TEST_F(EchoResponderTest, AHelloIsShort) {
    EXPECT_TRUE(ask(ProbeKind::kHello, 1, 1, kHere, kPort, kMaxDatagramBytes));
    EXPECT_FALSE(ask(ProbeKind::kHello, 1, 1, kHere, kPort, kMaxDatagramBytes + 1));
}

TEST_F(EchoResponderTest, ARepeatedHelloKeepsTheCounts) {
    ask(ProbeKind::kHello, 1);
    ask(ProbeKind::kProbe, kNonce);
    EXPECT_EQ(ask(ProbeKind::kHello, 1)->nonce, kNonce);
    EXPECT_EQ(ask(ProbeKind::kQuery, kNonce)->far_received, 1U);
    EXPECT_EQ(ask(ProbeKind::kHello, 2)->nonce, kNonce + 1);  // another test of the same host
    EXPECT_EQ(ask(ProbeKind::kQuery, kNonce + 1)->far_received, 0U);
}

TEST_F(EchoResponderTest, PlacesAreFewAndComeBack) {
    for (std::uint64_t asker = 0; asker < 8; ++asker) EXPECT_TRUE(ask(ProbeKind::kHello, asker));
    EXPECT_FALSE(ask(ProbeKind::kHello, 99));
    EXPECT_EQ(responder.counters().crowded, 1U);
    EXPECT_TRUE(ask(ProbeKind::kProbe, kNonce + 3));  // who is in stays in
    now += limits.idle + milliseconds{1};
    EXPECT_TRUE(ask(ProbeKind::kProbe, kNonce + 3));
    EXPECT_TRUE(ask(ProbeKind::kHello, 99));
    EXPECT_TRUE(ask(ProbeKind::kProbe, kNonce + 3));
    EXPECT_EQ(responder.counters().begun, 9U);
}

TEST_F(EchoResponderTest, HellosAndAnswersAreLimited) {
    int welcomed = 0;
    for (int i = 0; i < 1000; ++i) welcomed += ask(ProbeKind::kHello, 1) ? 1 : 0;
    EXPECT_EQ(welcomed, 50);
    now += seconds{1};
    int echoed = 0;
    for (std::uint32_t i = 0; i < 6000; ++i) echoed += ask(ProbeKind::kProbe, kNonce, i) ? 1 : 0;
    EXPECT_EQ(echoed, 5000);
    now += milliseconds{10};
    EXPECT_TRUE(ask(ProbeKind::kProbe, kNonce));  // they come back
    EXPECT_EQ(responder.counters().limited, 950U + 1000U);
}

}  // namespace
}  // namespace thimble
