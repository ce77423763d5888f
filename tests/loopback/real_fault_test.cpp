// Real programs that are killed or stopped at random instants, and stopped on purpose. How many: THIMBLE_FAULT_TRIALS
// (docs/reliability.md).
#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <map>
#include <string>
#include <sys/resource.h>
#include <sys/stat.h>
#include <thread>
#include <variant>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/codec.hpp"
#include "common/node_process.hpp"
#include "common/random.hpp"
#include "common/runtime/wall_clock.hpp"
#include "master/master_node.hpp"
#include "session/clocks/clock_summary.hpp"
#include "session/log/logged_file.hpp"
#include "tests/loopback/real_run.hpp"

namespace thimble {
namespace {

#if defined(__has_feature)
#if __has_feature(undefined_behavior_sanitizer) || __has_feature(address_sanitizer)
#define THIMBLE_SANITIZER_NEEDS_DESCRIPTORS
#endif
#endif
#ifdef THIMBLE_SANITIZER_NEEDS_DESCRIPTORS
constexpr bool kSanitizerNeedsDescriptors = true;
#else
constexpr bool kSanitizerNeedsDescriptors = false;
#endif
constexpr const char* kWhyNot =
    "this sanitizer looks at objects through pipes, for which there are no descriptors left";

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::array kVictimPrograms{"thimble-netem",  "thimble-slave-sim", "thimble-cutaneous",
                                     "thimble-visual", "thimble-master",    "thimble"};

struct RealFault {
    const char* program;
    int signal;
    bool goes_on;  // SIGSTOP, and after 200 ms SIGCONT: less than the silence that ends a trial
    Duration after;

    bool of_launcher() const { return program == kVictimPrograms.back(); }
};

// `longest_s`: of a trial without an end, before the fault. The needle presses from 3 s on.
RealFault draw_fault(std::uint32_t number, double longest_s) {
    RandomStream stream({815, 0, 0, number, Purpose::kInstance});
    const auto program = static_cast<std::size_t>(stream.uniform() * kVictimPrograms.size());
    const double kind = stream.uniform();
    const bool goes_on = kind > 0.75;
    return {kVictimPrograms.at(std::min(program, kVictimPrograms.size() - 1)), kind < 0.5 ? SIGKILL : SIGSTOP,
            goes_on, from_seconds((goes_on ? 0.3 : longest_s) * stream.uniform())};
}

void expect_clean_end(RealRun& run, bool lost) {
    EXPECT_EQ(run.end(), lost ? 3 : 0) << run.words();
    const TrialRow row = run.only_row();
    EXPECT_EQ(row.reason, lost ? EndReason::kPeerLost : EndReason::kCompleted);
    EXPECT_THAT(nodes_alive(run.base_port()), IsEmpty());
}

// Its nodes end by themselves; the trial that ran has what was recorded until then.
void expect_end_without_launcher(RealRun& run) {
    EXPECT_EQ(run.end(), 128 + SIGKILL) << run.words();
    EXPECT_TRUE(wait_until([&] { return nodes_alive(run.base_port()).empty(); }));
    EXPECT_THAT(run.rows(), IsEmpty()) << "no trial was completed";
    EXPECT_FALSE(run.first_trajectory().empty());
}

// Calls `use` with each message of a log: its topic, and when the program sent or read it.
// The program may still write the log.
template <class Use>
void for_each_message(const std::filesystem::path& log, Use use) {
    LoggedFile(log).for_each([&](const LoggedTopic& topic, const McapMessage& logged) {
        if (logged.data.size() > kMaxDatagramBytes) return;
        alignas(16) std::array<std::uint8_t, kMaxDatagramBytes> aligned{};
        std::copy(logged.data.begin(), logged.data.end(), aligned.begin());
        const Decoded decoded = decode({aligned.data(), logged.data.size()});
        const auto at = from_nanoseconds(static_cast<std::int64_t>(logged.log_time_ns));
        if (decoded.message) use(topic, at, *decoded.message);
    });
}

std::filesystem::path node_log(const RealRun& run, const std::string& program) {
    return run.out() / "nodes" / (program + "_0ms.mcap");
}

// The loss of a peer, by the log of a program that noticed it.
// A node gives the trial up then, and the session ends it.
class NoticedLoss {
  public:
    void look(const LoggedTopic& topic, SessionTime at, const Message& message) {
        if (noticed_) return;
        if (topic.sent) {
            noticed_ = says_lost(message);
            if (noticed_) silence_ = longest_silence(at);
        } else if (comes_often(message)) {
            heard_[topic.topic] = at;
        }
    }
    bool noticed() const { return noticed_; }
    // Of the quietest peer until then.
    Duration silence() const { return silence_; }

  private:
    static bool says_lost(const Message& sent) {
        if (const auto* node = std::get_if<Heartbeat>(&sent.body))
            return node->state == NodeState::kFailed && node->reason == EndReason::kPeerLost;
        const auto* order = std::get_if<SessionControl>(&sent.body);
        return order != nullptr && order->kind == ControlKind::kTrialEnd &&
               order->reason == EndReason::kPeerLost;
    }
    static bool comes_often(const Message& received) {
        return std::holds_alternative<NeedleCommand>(received.body) ||
               std::holds_alternative<ForceFeedback>(received.body) ||
               std::holds_alternative<Heartbeat>(received.body);
    }
    Duration longest_silence(SessionTime now) const {
        Duration longest{};
        for (const auto& [topic, at] : heard_) longest = std::max(longest, now - at);
        return longest;
    }

    std::map<std::string, SessionTime> heard_;  // the last message of each topic
    bool noticed_ = false;
    Duration silence_{};
};

NoticedLoss loss_by(const std::filesystem::path& log) {
    NoticedLoss loss;
    for_each_message(log, [&](const auto&... logged) { loss.look(logged...); });
    return loss;
}

// A busy machine may stop a program for longer than the test asks.
// So the programs' logs say whether a peer was lost, and after how long a silence.
bool peer_was_lost(const RealRun& run) {
    bool lost = false;
    Duration silence{};
    for (const auto& file : std::filesystem::directory_iterator(run.out() / "nodes")) {
        if (file.path().extension() != ".mcap") continue;
        const NoticedLoss loss = loss_by(file.path());
        lost = lost || loss.noticed();
        silence = std::max(silence, loss.silence());
    }
    EXPECT_TRUE(!lost || silence > kPeerTimeout - kHeartbeatPeriod)
        << "lost after " << to_seconds(silence) << " s";
    return lost;
}

// It stands still until slave_sim has given the trial up by itself. Then it finds out.
void let_launcher_go_on(RealRun& run) {
    EXPECT_TRUE(wait_until([&] { return loss_by(node_log(run, "thimble-slave-sim")).noticed(); }));
    kill(run.launcher().pid(), SIGCONT);
}

// The force at the handle by the master's log, against the forces that it had received. Its own clock counts, so that a machine
// that gave it no processor for a while changes nothing.
class HandleForces {
  public:
    void look(const LoggedTopic& topic, SessionTime at, const Message& message) {
        if (const auto* force = std::get_if<ForceFeedback>(&message.body)) {
            take(at, *force);
        } else if (const auto* said = std::get_if<NeedleCommand>(&message.body);
                   said != nullptr && topic.sent) {
            judge(message.header.send_time, said->force_hand_N);
        }
    }
    std::size_t judged() const { return judged_; }

  private:
    // A held needle answers no command, so its force is as old as the message.
    void take(SessionTime at, const ForceFeedback& force) {
        received_N_.push_back(std::clamp(-force.force_total_N, -kStrongest_N, kStrongest_N));
        heard_ = at;
        made_ = force.needle_held ? at : force.echo_time;
    }
    // As the master counts it. A force that came late is as old as the command that it answers.
    Duration silence(SessionTime now) const { return std::max(now - heard_, now - made_); }

    // A sample says what the handle gave until then, so a tick that came late says what a standing program left there.
    void judge(SessionTime now, double force_N) {
        const bool in_time = now - last_tick_ < milliseconds{5};
        last_tick_ = now;
        ++judged_;
        ASSERT_LE(std::abs(force_N), kStrongest_N);
        if (force_N == 0 || !in_time) return;
        const StalePolicy stale = MasterSettings{}.stale;
        const Duration silent = silence(now);
        ASSERT_LE(silent, stale.after + stale.ramp + milliseconds{10}) << force_N << " N beyond its time";
        const std::size_t kept = std::min<std::size_t>(received_N_.size(), 64);
        const bool came = std::find(received_N_.end() - static_cast<std::ptrdiff_t>(kept), received_N_.end(),
                                    force_N) != received_N_.end();
        ASSERT_TRUE(came || silent > stale.after - milliseconds{5}) << force_N << " N, which nobody sent";
    }

    static constexpr double kStrongest_N = 12;  // [guard] force_limit_N
    std::vector<double> received_N_;
    SessionTime heard_{}, made_{};  // the newest force
    SessionTime last_tick_{};
    std::size_t judged_ = 0;
};

void expect_forces_that_were_sent(const RealRun& run) {
    HandleForces forces;
    for_each_message(node_log(run, "thimble-master"), [&](const auto&... logged) { forces.look(logged...); });
    EXPECT_GT(forces.judged(), 50U);
}

void expect_nothing_left(const std::vector<pid_t>& programs) {
    for (const pid_t pid : programs)
        EXPECT_TRUE(wait_until([pid] { return !is_left_over(pid); }))
            << pid << " is still there, or a zombie";
}

// The fault, and what becomes of the run.
void carry_out(const RealFault& fault, RealRun& run) {
    const pid_t pid = fault.of_launcher() ? run.launcher().pid() : run.node(fault.program);
    kill(pid, fault.signal);
    if (fault.of_launcher() && fault.signal == SIGKILL) return expect_end_without_launcher(run);
    if (fault.goes_on) {
        std::this_thread::sleep_for(milliseconds{200});
        kill(pid, SIGCONT);
        EXPECT_THAT(zombies_of(run.launcher().pid()), IsEmpty());
    } else if (fault.of_launcher()) {
        let_launcher_go_on(run);
    } else if (fault.signal == SIGKILL) {
        EXPECT_TRUE(wait_until([&] { return !is_left_over(pid); })) << "its launcher does not wait for it";
    }
    run.end();  // the logs are whole from here on
    expect_clean_end(run, !fault.goes_on || peer_was_lost(run));
}

TEST(RealFaults, AtRandomInstants) {
    const char* wanted = std::getenv("THIMBLE_FAULT_TRIALS");
    const auto trials = static_cast<std::uint32_t>(wanted == nullptr ? 1 : std::atoi(wanted));
    for (std::uint32_t number = 1; number <= trials; ++number) {
        const RealFault fault = draw_fault(number, trials > 1 ? 6 : 0.3);
        SCOPED_TRACE(std::string(fault.program) + (fault.signal == SIGKILL ? " killed" : " stopped") +
                     (fault.goes_on ? " for 200 ms" : ""));
        SessionFile session;
        session.more = "[log]\nmessages = \"all\"\n";
        if (!fault.goes_on) session.contact_hold_s = kEndlessHold_s;
        RealRun run(session);
        ASSERT_TRUE(run.reaches_trial()) << run.words();
        std::vector<pid_t> programs;
        for (const char* program : kNodePrograms) programs.push_back(run.node(program));
        std::this_thread::sleep_for(fault.after);
        carry_out(fault, run);
        expect_nothing_left(programs);
        expect_forces_that_were_sent(run);
        if (HasFailure()) return;
    }
}

constexpr int kStands = -2;
constexpr int kNotLoaded = 127;  // the loader lacks descriptors: the test has inherited some

// Until it ends, or is ready.
Outcome run_limited(const std::string& command) {
    const Folder folder;
    Child child("/bin/sh", {"-c", command}, folder / "words");
    const auto words = [&] { return read_text(folder / "words"); };
    wait_until([&] { return child.poll() || words().find("ready") != std::string::npos; });
    return {child.poll().value_or(kStands), words()};
}

// Nothing to open a socket with: said in words, with the exit code of the network, and nothing hangs.
TEST(RealFaults, OutOfFileDescriptors) {
    if (kSanitizerNeedsDescriptors) GTEST_SKIP() << kWhyNot;
    for (const char* program : kNodePrograms) {
        const PortBlock ports;
        int refused = 0;
        for (unsigned limit = 4; limit < 40; ++limit) {
            const std::string command = fmt::format("ulimit -n {}; exec {} --base-port {}", limit,
                                                    (built_programs() / program).string(), ports.base());
            const Outcome outcome = run_limited(command);
            if (outcome.code == kStands) break;
            if (outcome.code == kNotLoaded) continue;
            ++refused;
            EXPECT_EQ(outcome.code, 3) << limit << ' ' << outcome.words;
            EXPECT_THAT(outcome.words, HasSubstr("; raise 'ulimit -n'")) << program << ' ' << limit;
        }
        EXPECT_GT(refused, 0) << program;
    }
}

// From here on whatever these programs want to open is refused; what is open stays open.
void take_descriptors(pid_t pid) {
    const rlimit none{3, 3};
    ASSERT_EQ(prlimit(pid, RLIMIT_NOFILE, &none, nullptr), 0) << std::strerror(errno);
}

// A node opens nothing while it runs: the trial goes on to its end. It reports that it cannot write its report.
TEST(RealFaults, NodesOutOfFileDescriptorsInARunKeepTheTrial) {
    if (kSanitizerNeedsDescriptors) GTEST_SKIP() << kWhyNot;
    RealRun run(SessionFile::unhurried());
    std::vector<pid_t> nodes;
    nodes.reserve(kNodePrograms.size());
    for (const char* program : kNodePrograms) nodes.push_back(run.node(program));
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    for (const pid_t node : nodes) take_descriptors(node);
    run.end();
    EXPECT_EQ(run.only_reason(), EndReason::kCompleted) << run.words();
    EXPECT_THAT(read_text(run.out() / "nodes/thimble-slave-sim_0ms.log"), HasSubstr("ulimit -n"));
    EXPECT_THAT(nodes_alive(run.base_port()), IsEmpty());
}

// thimble opens files between trials: the running one is kept, the run ends in words.
TEST(RealFaults, ASessionOutOfFileDescriptorsInARunLosesNoTrial) {
    if (kSanitizerNeedsDescriptors) GTEST_SKIP() << kWhyNot;
    SessionFile file = SessionFile::unhurried();
    file.modalities = R"(["HF", "CF"])";
    RealRun run(file);
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    take_descriptors(run.launcher().pid());
    expect_end(run, 1, EndReason::kCompleted, "ulimit -n");
}

// The trial ends at once, not at its own end.
TEST(RealFaults, AnOutputFolderThatIsDeletedEndsTheTrial) {
    RealRun run(SessionFile::endless());
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    std::filesystem::remove_all(run.out());
    EXPECT_EQ(run.end(), 1) << run.words();
    EXPECT_THAT(run.words(), HasSubstr("was deleted during the run"));
    EXPECT_THAT(nodes_alive(run.base_port()), IsEmpty());
}

// The guard of a session file is the one before the real program's handle.
TEST(Guard, TripsInTheRealProgramAsTheSessionFileSays) {
    SessionFile session;
    session.delays_s = "[0.05]";
    session.contact_hold_s = kEndlessHold_s;
    session.more = "[guard]\nenergy_limit_J = 0.001\n";
    RealRun run(session, kLockStep);
    expect_end(run, 1, EndReason::kSafetyStop, "[guard] energy_limit_J = 0.001");
}

// A pipe stands for the file of the clocks. It is full from the first samples on.
TEST(SlowDisk, DelaysTheEndOfARunAndNoTrial) {
    const Folder folder;
    std::filesystem::create_directories(folder / "nodes");
    const std::filesystem::path clocks = folder / "nodes" / "clocks_0ms.csv";
    ASSERT_EQ(::mkfifo(clocks.c_str(), 0600), 0);
    const int disk = ::open(clocks.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    std::string bytes(1 << 16, ' ');
    const PortBlock ports;
    const std::string file = folder.write("session.toml", SessionFile{}.text()).string();
    Child run(built_programs() / "thimble",
              {"run", file, "--out", (folder / "").string(), "--base-port", std::to_string(ports.base())},
              folder / "words");
    const auto words = [&] { return read_text(folder / "words"); };
    const auto trajectory = folder / "trajectories" / "trial01_HF_0ms.csv";
    ASSERT_TRUE(wait_until([&] { return !read_text(trajectory).empty(); })) << words();
    for (const std::size_t size : {bytes.size(), std::size_t{1}}) {
        while (::write(disk, bytes.data(), size) > 0) {
        }
    }
    std::this_thread::sleep_for(3 * kPeerTimeout);
    // The run reads them in the end.
    ClockWriter(folder / "clocks.csv").flush();
    std::filesystem::rename(folder / "clocks.csv", clocks);
    EXPECT_TRUE(wait_until([&] { return ::read(disk, bytes.data(), bytes.size()) < 0 && run.poll(); }));
    ::close(disk);
    EXPECT_EQ(run.wait(kPatience), 0) << words();
    const auto rows = read_trial_table(folder / "trials.csv");
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(rows[0].reason, EndReason::kCompleted);
}

}  // namespace
}  // namespace thimble
