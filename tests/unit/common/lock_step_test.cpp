// The protocol of lock-step, and channels that wait for what was announced.
#include "common/runtime/lock_step.hpp"

#include <array>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "tests/guarded_ports.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr Duration kShort = milliseconds{50};

class Ends : public testing::Test {
  protected:
    Ends() {
        std::array<int, 2> pair{};
        EXPECT_EQ(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair.data()), 0);
        conductor_.emplace(pair[0], kShort);
        node_.emplace(pair[1], Duration{});
    }
    std::optional<LockStepEnd> conductor_, node_;
};

LockStepMessage message_of(LockStepKind kind, std::int64_t time_ns = 0) {
    LockStepMessage message;
    message.kind = kind;
    message.time_ns = time_ns;
    return message;
}

// Sends as many datagrams as it gets, to another port, and is due again a millisecond later.
class Echo final : public Process {
  public:
    explicit Echo(Sockets& sockets)
        : in_(sockets.inlet(Port::kSlaveNeedle)), out_(sockets.outlet(Port::kNetemForceMaster)) {}
    void tick(SessionTime now) override {
        next_ = std::max(next_, now + milliseconds{1} - now.time_since_epoch() % milliseconds{1});
        for (Bytes taken = in_->receive(); !taken.empty(); taken = in_->receive()) {
            EXPECT_EQ(taken[0], 4);
            out_->send(std::array<std::uint8_t, 3>{1, 2, 3});
        }
    }
    SessionTime next_wakeup() const override { return next_; }
    bool stopped() const override { return false; }

  private:
    Channel *in_, *out_;
    SessionTime next_{};
};

NetworkSettings somewhere() {
    static const GuardedPorts ports;
    NetworkSettings network;
    network.security.mode = SecurityMode::kNone;
    network.base_port = ports.base();
    return network;
}

TEST_F(Ends, AnotherVersionIsRefused) {
    LockStepMessage other = message_of(LockStepKind::kAnswer);
    other.version = 7;
    ASSERT_TRUE(node_->send(other));
    EXPECT_THAT(refusal([&] { conductor_->receive(); }, ExitCode::kNetwork),
                HasSubstr("version 7, but this program uses version 2"));
}

TEST_F(Ends, OneThatSaysNothingIsLateAndOneThatEndsIsGone) {
    EXPECT_FALSE(conductor_->receive());
    EXPECT_EQ(conductor_->silence(), LockStepEnd::Silence::kLate);
    node_.reset();
    EXPECT_FALSE(conductor_->receive());
    EXPECT_EQ(conductor_->silence(), LockStepEnd::Silence::kGone);
    EXPECT_FALSE(conductor_->send(message_of(LockStepKind::kGrant)));
}

TEST(LockStep, StandardInputMustBeAConductor) {
    EXPECT_THAT(refusal([] { const LockStepEnd end(dup(STDERR_FILENO), Duration{}); }, ExitCode::kUsage),
                HasSubstr("lock-step needs a controller at standard input"));
}

class WayOfGrants : public Ends, public testing::WithParamInterface<bool> {};
INSTANTIATE_TEST_SUITE_P(BySocketOrPage, WayOfGrants, testing::Bool());

TEST_P(WayOfGrants, AGrantIsAnsweredWithTheNextWakeUpAndWhatWasSent) {
    if (GetParam()) conductor_->offer_page();
    Sockets sockets(somewhere()), sender(somewhere()), stranger(somewhere());
    sockets.count_datagrams(kShort);
    Echo echo(sockets);
    sender.count_datagrams(kShort);  // so it sends from a port of the session
    sender.between(Port::kNetemControl, Port::kSessionNetem);
    Channel *const needle = sender.outlet(Port::kSlaveNeedle), *const foreign =
                                                                   stranger.outlet(Port::kSlaveNeedle);
    for (int i = 0; i < 3; ++i) {
        foreign->send(std::array<std::uint8_t, 2>{6, 6});  // not announced: it does not stand for another
        needle->send(std::array<std::uint8_t, 2>{4, 5});
    }
    conductor_->send(message_of(LockStepKind::kBegin));
    std::thread node([&] {
        EXPECT_EQ(node_->receive()->kind, LockStepKind::kBegin);
        EXPECT_EQ(run_in_lock_step(*node_, echo, sockets)->kind, LockStepKind::kEnd);
    });
    const auto ready = conductor_->receive();
    LockStepMessage grant = message_of(LockStepKind::kGrant, 5'000'000);
    grant.datagrams[static_cast<std::size_t>(Port::kSlaveNeedle)] = 2;  // the third has not been announced
    conductor_->send(grant);
    const auto answer = conductor_->receive();
    for (const std::int64_t time_ns : {5'200'000, 5'400'000})
        conductor_->send(message_of(LockStepKind::kQuietGrant, time_ns));
    conductor_->send(message_of(LockStepKind::kGrant, 6'000'000));
    const auto next = conductor_->receive();
    conductor_->send(message_of(LockStepKind::kEnd));
    node.join();
    ASSERT_TRUE(ready && answer && next);
    EXPECT_EQ(ready->kind, LockStepKind::kReady);
    EXPECT_EQ(ready->by_page, GetParam() ? 1U : 0U);
    EXPECT_EQ(answer->kind, LockStepKind::kAnswer);
    EXPECT_EQ(answer->time_ns, 6'000'000);
    EXPECT_EQ(answer->datagrams[static_cast<std::size_t>(Port::kNetemForceMaster)], 2);
    EXPECT_EQ(next->time_ns, 7'000'000);
    EXPECT_EQ(next->datagrams[static_cast<std::size_t>(Port::kNetemForceMaster)], 0);
}

// A disk that is full may make it speak: that is late, and not lost.
TEST_F(Ends, DatagramsOfAQuietGrantCountInTheNextAnswer) {
    Sockets sockets(somewhere()), sender(somewhere());
    sockets.count_datagrams(kShort);
    sender.count_datagrams(kShort);
    Echo echo(sockets);
    sender.between(Port::kNetemControl, Port::kSessionNetem);
    sender.outlet(Port::kSlaveNeedle)->send(std::array<std::uint8_t, 2>{4, 5});
    LockStepMessage grant = message_of(LockStepKind::kQuietGrant);
    grant.datagrams[static_cast<std::size_t>(Port::kSlaveNeedle)] = 1;
    conductor_->send(grant);
    conductor_->send(message_of(LockStepKind::kGrant, 1'000'000));
    conductor_->send(message_of(LockStepKind::kEnd));
    run_in_lock_step(*node_, echo, sockets, [] { return from_nanoseconds(77); });
    EXPECT_EQ(conductor_->receive()->kind, LockStepKind::kReady);
    const auto answer = conductor_->receive();
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->datagrams[static_cast<std::size_t>(Port::kNetemForceMaster)], 1);
    EXPECT_EQ(answer->instance, 77U);
}

TEST_F(Ends, APageDoesNotHideThatANodeIsLateOrGone) {
    conductor_->offer_page();
    conductor_->send(message_of(LockStepKind::kBegin));
    ASSERT_TRUE(node_->receive());
    node_->send(message_of(LockStepKind::kReady));
    ASSERT_TRUE(conductor_->receive());
    EXPECT_FALSE(conductor_->receive());
    EXPECT_EQ(conductor_->silence(), LockStepEnd::Silence::kLate);
    node_.reset();
    EXPECT_FALSE(conductor_->receive());
    EXPECT_EQ(conductor_->silence(), LockStepEnd::Silence::kGone);
}

// A stop, which the session takes as soon as it is there.
TEST(LockStep, ADatagramThatIsTakenBeforeItIsAnnouncedIsNotWaitedFor) {
    Sockets sockets(somewhere()), sender(somewhere());
    sockets.count_datagrams(kShort);
    sender.count_datagrams(kShort);
    Channel* const in = sockets.inlet(Port::kSlaveNeedle);
    sender.between(Port::kNetemControl, Port::kSessionNetem);
    sender.outlet(Port::kSlaveNeedle)->send(std::array<std::uint8_t, 2>{4, 5});
    ASSERT_TRUE(sockets.hear_outside(Port::kSlaveNeedle));
    EXPECT_EQ(in->receive().size(), 2U);
    EXPECT_TRUE(in->receive().empty());
    sockets.announce(sender.take_sent());
    EXPECT_TRUE(in->receive().empty());
}

TEST_F(Ends, ADatagramThatDoesNotComeNamesItsFlow) {
    Sockets sockets(somewhere());
    sockets.count_datagrams(kShort);
    Echo echo(sockets);
    LockStepMessage grant = message_of(LockStepKind::kGrant);
    grant.datagrams[static_cast<std::size_t>(Port::kSlaveNeedle)] = 1;
    conductor_->send(grant);
    EXPECT_THAT(refusal([&] { run_in_lock_step(*node_, echo, sockets); }, ExitCode::kNetwork),
                HasSubstr("of 'needle' from netem to slave_sim: 1 announced datagram did not come"));
}

}  // namespace
}  // namespace thimble
