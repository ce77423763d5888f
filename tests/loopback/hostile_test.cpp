// A trial among hostile datagrams goes on; each is counted by its name.
#include <map>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/runtime/wall_clock.hpp"
#include "tests/loopback/hostile_peer.hpp"
#include "tests/loopback/lone_node.hpp"
#include "tests/loopback/real_run.hpp"

namespace thimble {
namespace {

void expect_undisturbed(RealRun& run) {
    EXPECT_EQ(run.end(), 0) << run.words();
    const auto rows = run.rows();
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(rows.front().reason, EndReason::kCompleted);
    EXPECT_TRUE(rows.front().metrics.beeped);
    EXPECT_LT(rows.front().metrics.penetration_max_m, 0.02);  // a needle at 0.2 m would have been far beyond
}

// Until the run is over, with a pause in between, so that the trial is disturbed and not drowned.
TEST(HostileRun, BrokenDatagramsStrangersAndSecondSendersAtEveryPort) {
    RealRun run(SessionFile{});
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    HostilePeer peer(run.base_port());
    const SessionTime end = wall_now() + 3 * kPatience;
    while (!run.launcher().poll() && wall_now() < end) {
        peer.send_broken();
        peer.send_as_second_sender(1);
        peer.send_from_strangers();
        std::this_thread::sleep_for(std::chrono::milliseconds{5});
    }
    expect_undisturbed(run);
    for (const char* program : kNodePrograms) {
        const auto refused = run.report(program).at("refused");
        for (const char* name : {"too_short", "malformed", "foreign_format", "not_finite", "out_of_range",
                                 "too_long", "second_sender", "foreign_source"}) {
            EXPECT_GT(refused.at(name), 0) << program << ' ' << name;
        }
    }
}

// Every refusal that needs the true sender's instance, exactly once each, and a sequence that wraps on the
// way.
class CountedRefusals : public testing::Test {
  protected:
    static constexpr std::uint32_t kLast = 0xFFFFFFFF;
    static constexpr Header kFirst{7, from_nanoseconds(1'000'000'000), kLast - 1, kPlayedTrial,
                                   Role::kMaster};

    CountedRefusals()
        : needle_(std::nullopt, node_.at(Port::kSlaveNeedle)),
          stranger_(Endpoint{"127.0.0.2", 0}, node_.at(Port::kSlaveNeedle)),
          answers_(node_.peers().inlet(Port::kNetemForceMaster)) {}

    // `kFirst` with another sequence, sent that many milliseconds after it.
    static Header later(std::uint32_t sequence, int milliseconds) {
        Header header = kFirst;
        header.sequence = sequence;
        header.send_time += std::chrono::milliseconds{milliseconds};
        return header;
    }
    void send(const Header& header) { needle_.send(datagram(header, NeedleCommand{})); }
    void send_all() {
        send(kFirst);
        send(kFirst);               // duplicate
        send(later(kLast - 2, 0));  // outdated
        send(later(kLast, 1));      // accepted
        send(later(0, 0));          // its stamp goes back
        send(later(0, 2));          // accepted: the sequence wraps
        send(later(kLast, 3));      // outdated, although its number is higher
        Header header = later(1, 3);
        header.instance = 8;
        send(header);  // second sender
        header = later(1, 3);
        header.sender = Role::kVisual;
        send(header);  // unexpected kind
        header = later(1, 3);
        header.trial = kPlayedTrial + 1;
        send(header);  // wrong trial
        for (const auto& bytes : broken_datagrams()) needle_.send(bytes);
        stranger_.send(datagram(later(2, 4), NeedleCommand{}));
        send(later(2, 4));  // accepted
    }
    // Sequences of the commands that were answered, until that of the last one.
    std::vector<std::uint32_t> answered() {
        std::vector<std::uint32_t> sequences;
        InboundFlow flow(Role::kSlaveSim);
        wait_until([&] {
            while (const Message* message = flow.receive(wall_now(), *answers_)) {
                const auto* feedback = std::get_if<ForceFeedback>(&message->body);
                if (feedback != nullptr && !feedback->needle_held)
                    sequences.push_back(feedback->echo_sequence);
            }
            return !sequences.empty() && sequences.back() == 2;
        });
        return sequences;
    }

    LoneNode node_{"thimble-slave-sim"};
    UdpChannel needle_, stranger_;
    Channel* answers_;
};

TEST_F(CountedRefusals, OfASlaveInMidTrial) {
    ASSERT_TRUE(node_.ready()) << node_.words();
    PlayedSession session(node_, Role::kSlaveSim, Modality::kHF);
    ASSERT_TRUE(session.play([](SessionTime) {}, [&] { return session.state() == NodeState::kRunning; }));
    send_all();
    EXPECT_THAT(answered(), testing::ElementsAre(kLast - 1, kLast, 0, 2));
    EXPECT_EQ(node_.terminate(), 0);
    const std::map<std::string, std::uint64_t> expected{{"too_short", 1},
                                                        {"too_long", 2},
                                                        {"foreign_format", 1},
                                                        {"malformed", 1},
                                                        {"not_one_body", 0},
                                                        {"not_finite", 1},
                                                        {"out_of_range", 1},
                                                        {"unexpected_kind", 1},
                                                        {"foreign_source", 1},
                                                        {"second_sender", 1},
                                                        {"duplicate", 1},
                                                        {"outdated", 2},
                                                        {"stamp_not_increasing", 1},
                                                        {"wrong_trial", 1}};
    EXPECT_EQ((node_.report().at("refused").get<std::map<std::string, std::uint64_t>>()), expected);
}

}  // namespace
}  // namespace thimble
