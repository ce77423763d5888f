// thimble run by another clock than the wall's: the same trials, the same files.
#include <algorithm>
#include <cstdlib>
#include <map>
#include <random>
#include <sys/resource.h>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/runtime/wall_clock.hpp"
#include "session/records/trial_table.hpp"
#include "tests/loopback/drawn_session.hpp"
#include "tests/loopback/played_view.hpp"
#include "tests/loopback/programs.hpp"
#include "tests/loopback/real_run.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* kEasy =
    "[session]\nmodalities = ['HF', 'CF']\ndelays_s = [0.0, 0.05]\n[trial]\ncontact_hold_s = 0.5\n";

constexpr const char* kOneByOne =
    "[session]\nmodalities = ['HF', 'CF']\ndelays_s = [0.0]\n[trial]\ncontact_hold_s = 0.5\n";
constexpr const char* kOneTrial =
    "[session]\nmodalities = ['HF']\ndelays_s = [0.05]\n[trial]\ncontact_hold_s = 0.3\n";

std::map<std::string, std::string> files_in(const fs::path& folder) {
    std::map<std::string, std::string> texts;
    for (const auto& file : fs::directory_iterator(folder))
        texts[file.path().filename().string()] = read_text(file.path());
    EXPECT_FALSE(texts.empty()) << folder;
    return texts;
}

// For a run in lock-step, which the thread sanitizer makes ten times as long.
constexpr Duration kRunPatience = 2 * kPatience;

class RunByClock : public testing::Test {
  protected:
    std::vector<std::string> arguments(const std::string& text, const std::string& clock,
                                       const std::vector<std::string>& more = {}) {
        const std::string file = folder_.write("session.toml", text).string();
        out_ = folder_ / clock;
        return words_in(fmt::format("run {} --clock {} --out {} --base-port {}", file, clock, out_.string(),
                                    ports_.base()),
                        more);
    }
    Outcome run(const std::string& text, const std::string& clock,
                const std::vector<std::string>& more = {}) {
        return run_thimble(arguments(text, clock, more));
    }
    void expect_refused(const std::string& text, const std::string& clock, const std::string& words,
                        const std::vector<std::string>& more = {}) {
        const Outcome outcome = run(text, clock, more);
        EXPECT_EQ(outcome.code, 2) << words;
        EXPECT_THAT(outcome.words, HasSubstr(words));
        EXPECT_FALSE(fs::exists(out_));
    }
    // The files that both have left.
    void expect_same_bytes() const {
        const fs::path one = folder_ / "lock-step", other = folder_ / "virtual";
        EXPECT_EQ(read_text(one / "trials.csv"), read_text(other / "trials.csv"));
        EXPECT_NE(read_text(one / "trials.csv"), "");
        EXPECT_TRUE(files_in(one / "trajectories") == files_in(other / "trajectories"));
        EXPECT_THAT(nodes_alive(ports_.base()), testing::IsEmpty());
    }
    void expect_both_agree(const std::string& text, int code = 0) {
        for (const char* clock : {"virtual", "lock-step"}) {
            const Outcome outcome = run(text, clock);
            ASSERT_EQ(outcome.code, code) << outcome.words;
        }
        expect_same_bytes();
    }
    // A run that goes on, beside which a test does something.
    Child start(const std::string& text, const std::vector<std::string>& more = {}) {
        return {built_programs() / "thimble", arguments(text, "lock-step", more), folder_ / "words"};
    }
    std::vector<pid_t> nodes(const std::string& program) const { return node_pids(ports_.base(), program); }
    std::string words() const { return read_text(folder_ / "words"); }
    // A run that stands still in its second trial until the test types "c".
    Child start_into_second_trial(const std::vector<std::string>& more = {}) {
        std::vector<std::string> all = arguments(kOneByOne, "lock-step", more);
        all.emplace_back("--step");
        Child child(built_programs() / "thimble", all, folder_ / "words", {typing_.input()});
        typing_.type("1000\n0.5\n");  // the first trial to its end, and half a second of the next one
        EXPECT_TRUE(wait_until([&] { return words().find("trial 2, 0 ms CF, at 0.5") != std::string::npos; },
                               kRunPatience))
            << words();
        return child;
    }

    const Folder folder_;
    const PortBlock ports_;
    const Typing typing_;
    fs::path out_;
};

TEST_F(RunByClock, VirtualTimeWritesTheFilesOfARun) {
    const Outcome outcome = run(kEasy, "virtual");
    ASSERT_EQ(outcome.code, 0) << outcome.words;
    for (const char* file : {"report.html", "findings.json", "trajectories/trial02_CF_50ms.csv"})
        EXPECT_TRUE(fs::exists(out_ / file)) << file;
    EXPECT_FALSE(fs::exists(out_ / "nodes"));
    const auto summary = nlohmann::json::parse(read_text(out_ / "summary.json"));
    EXPECT_EQ(summary.at("clock"), "virtual");
    EXPECT_GT(summary.at("simulated_s"), 10);
    EXPECT_GT(summary.at("wall_s"), 0);
    const std::string first = read_text(out_ / "trials.csv");
    fs::create_directories(out_ / "nodes");  // as an earlier, longer run in lock-step has left it
    const fs::path log = folder_.write("virtual/nodes/thimble-netem_100ms_trial09.mcap", "old");
    const fs::path other = folder_.write("virtual/nodes/session_notes.mcap", "mine");
    // As a study has left them: `thimble analyse` and replays would take them for this run's.
    const fs::path control = folder_.write("virtual/control.csv", "old");
    const fs::path old =
        folder_.write("virtual/trajectories/experiment3_subject01_trial02_CF_50ms.csv", "old");
    ASSERT_EQ(run(kEasy, "virtual", {"--overwrite"}).code, 0);
    EXPECT_EQ(read_text(out_ / "trials.csv"), first);
    for (const fs::path& left : {log, control, old}) EXPECT_FALSE(fs::exists(left)) << left;
    EXPECT_TRUE(fs::exists(other));
}

TEST_F(RunByClock, RefusesWhateverLivesByTheWallClock) {
    const std::string easy = kEasy;
    expect_refused(easy, "virtual", "--attach", {"--attach"});
    expect_refused(easy, "virtual", "--strict-rt", {"--strict-rt"});
    expect_refused(easy, "virtual", "--monitor", {"--monitor"});
    expect_refused(easy, "virtual", "--answer-limit-s", {"--answer-limit-s", "5"});
    expect_refused(easy + "[log]\nmessages = 'all'\n", "virtual", "[log]");
    expect_refused(easy + "[handle]\ndevice = 'pointer'\n", "virtual", "[handle] device");
    expect_refused(easy + "[cutaneous]\ndevice = 'board'\n", "virtual", "[cutaneous]");
    expect_refused(easy + "[launch]\nmachine_slave_sim = 'elsewhere'\n", "virtual", "[launch]");
    expect_refused(easy + "[protocol]\n", "virtual", "[protocol]");
}

TEST_F(RunByClock, LockStepHasNoWindow) {
    expect_refused(std::string(kEasy) + "[visual]\ndisplay = 'window'\n", "lock-step", "[visual]");
}

// Every node reads the same [control]; waves go there and back, and no node refuses any.
TEST_F(RunByClock, LockStepTakesACompensator) {
    expect_both_agree(std::string(kOneTrial) + "[control]\ncompensator = 'wave'\nwave_jitter_s = 0.02\n");
    const auto rows = read_trial_table(out_ / "trials.csv");
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(rows[0].reason, EndReason::kCompleted);
    EXPECT_TRUE(rows[0].metrics.beeped);
    for (const char* program : kNodePrograms) {
        const std::string report = read_text(out_ / "nodes" / fmt::format("{}_50ms.json", program));
        expect_report(nlohmann::json::parse(report), program);
    }
}

TEST_F(RunByClock, LockStepTakesASceneAndANetworkThatLoses) {
    expect_both_agree(std::string(kOneTrial) +
                      "[slave_sim]\nscene = 'vessel.toml'\n[netem.needle]\nloss = 0.01\n[netem.force]\n"
                      "jitter = 'uniform'\njitter_spread_s = 0.002\n");
}

// However quick the condition is that its guard stops.
TEST_F(RunByClock, AConditionThatIsStoppedEndsNoOther) {
    expect_both_agree(
        "[session]\nmodalities = ['HF', 'CF']\ndelays_s = [0.0, 0.1]\nparallel_conditions = 2\n"
        "[trial]\ncontact_hold_s = 0.3\n[guard]\nenergy_limit_J = 0.1\n",
        1);
    EXPECT_EQ(read_trial_table(out_ / "trials.csv").size(), 3U);
}

// Its random numbers reach the keys and nothing else: virtual time has no keys at all.
TEST_F(RunByClock, LockStepTakesALabKey) {
    expect_both_agree(std::string(kOneTrial) + under_lab_key(folder_ / "lab.key"));
}

// They hear one session, whatever trial runs, and change no byte of it.
TEST_F(RunByClock, LockStepMindsNoView) {
    ASSERT_EQ(run(kOneByOne, "virtual").code, 0);
    const PortBlock others;
    UdpChannel plot(Endpoint{"127.0.0.1", others.base()}, {"127.0.0.1", 0});
    PlayedView view(ports_.base(), PlayedView::Ports::kExperimenter, {});
    Child child = start(kOneByOne, {"--monitor", "--plotjuggler", std::to_string(others.base())});
    bool plotted = false;
    const bool ended = wait_until(
        [&] {
            view.listen(wall_now());
            plotted = plotted || !plot.receive().empty();
            return child.poll().has_value();
        },
        kRunPatience);
    ASSERT_TRUE(ended);
    view.listen(wall_now());
    EXPECT_EQ(child.poll(), 0) << words();
    EXPECT_THAT(view.trials(), testing::ElementsAre(1U, 2U));
    EXPECT_FALSE(view.running()) << "it has not heard how the last trial ended";
    EXPECT_TRUE(plotted);
    expect_same_bytes();
}

TEST_F(RunByClock, LockStepEndsWhereItsExperimenterSaysQuit) {
    PlayedView view(ports_.base(), PlayedView::Ports::kExperimenter, {});
    Child child = start(SessionFile::endless(kEndlessInLockStep_s).text(), {"--monitor"});
    Order quit;
    quit.kind = OrderKind::kQuit;
    const bool ended = wait_until([&] {
        view.listen(wall_now());
        if (view.running()) view.order(wall_now(), quit);
        return child.poll().has_value();
    });
    ASSERT_TRUE(ended);
    EXPECT_EQ(child.poll(), 1) << words();
    EXPECT_EQ(read_trial_table(out_ / "trials.csv").back().reason, EndReason::kInterrupted);
}

// How many sessions are drawn: THIMBLE_DRAWN_SESSIONS (docs/reliability.md).
std::uint32_t drawn_sessions() {
    const char* wanted = std::getenv("THIMBLE_DRAWN_SESSIONS");
    return wanted == nullptr ? 12 : static_cast<std::uint32_t>(std::atoi(wanted));
}

class DrawnByClock : public RunByClock, public testing::WithParamInterface<std::uint32_t> {
  protected:
    // The session is drawn, and has run in virtual time.
    void draw(std::uint32_t number) {
        text_ = DrawnSession(number, folder_ / "lab.key").text();
        const Outcome outcome = run(text_, "virtual");
        code_ = outcome.code;
        ASSERT_NE(code_, 2) << outcome.words << text_;  // its guard may stop it, and its network lose a node
    }
    // Holds one program up, and changes its priority. Beside compilers a program of the last priority would get nothing.
    void disturb(std::minstd_rand& random, pid_t pid) {
        setpriority(PRIO_PROCESS, static_cast<id_t>(pid), static_cast<int>(random() % kPriorities));
        kill(pid, SIGSTOP);
        wall_sleep(std::chrono::milliseconds{random() % 10});
        kill(pid, SIGCONT);
        ++disturbed_;
    }

    static constexpr unsigned kPriorities = 6;
    std::string text_;
    int code_ = 0, disturbed_ = 0;
};
INSTANTIATE_TEST_SUITE_P(Each, DrawnByClock, testing::Range(1U, 1 + drawn_sessions()));

TEST_P(DrawnByClock, LockStepGivesTheBytesOfVirtualTime) {
    draw(GetParam());
    SCOPED_TRACE(text_);
    const Outcome outcome = run(text_, "lock-step");
    EXPECT_EQ(outcome.code, code_) << outcome.words;
    expect_same_bytes();
}

// The conductor is one of those that are stopped and continued.
TEST_P(DrawnByClock, LockStepMindsNoProgramThatIsHeldUp) {
    constexpr std::uint32_t kOthers = 1'000'000;  // than those of the test above
    draw(kOthers + GetParam());
    SCOPED_TRACE(text_);
    Child child = start(text_);
    std::minstd_rand random(GetParam());
    while (!child.poll()) {
        std::vector<pid_t> pids{child.pid()};
        const auto program = random() % (kNodePrograms.size() + 1);
        if (program < kNodePrograms.size()) pids = nodes(kNodePrograms.at(program));
        for (const pid_t pid : pids) disturb(random, pid);
        wall_sleep(std::chrono::milliseconds{random() % 30});
    }
    EXPECT_EQ(child.poll(), code_) << words();
    EXPECT_GT(disturbed_, 5);
    expect_same_bytes();
}

TEST_F(RunByClock, LockStepKeepsTheTrialsBeforeANodeThatDies) {
    Child child = start_into_second_trial();
    for (const pid_t pid : nodes("thimble-slave-sim")) kill(pid, SIGKILL);
    typing_.type("c\n");
    EXPECT_EQ(child.wait(kPatience), 3);
    EXPECT_THAT(words(), HasSubstr("thimble-slave-sim ended with code 137"));
    const auto rows = read_trial_table(out_ / "trials.csv");
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_EQ(rows[0].reason, EndReason::kCompleted);
    EXPECT_EQ(rows[1].reason, EndReason::kPeerLost);
    EXPECT_EQ(rows[1].lost_peer, Role::kSlaveSim);
    EXPECT_TRUE(fs::exists(out_ / "report.html"));
}

TEST_F(RunByClock, LockStepNamesANodeThatNeverAnswers) {
    Child child = start_into_second_trial({"--answer-limit-s", "5"});
    for (const pid_t pid : nodes("thimble-visual")) kill(pid, SIGSTOP);
    typing_.type("c\n");
    EXPECT_EQ(child.wait(kPatience), 3);
    EXPECT_THAT(words(), HasSubstr("thimble-visual has not answered within 5 s"));
    const auto rows = read_trial_table(out_ / "trials.csv");
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_EQ(rows[1].reason, EndReason::kPeerLost);
    EXPECT_EQ(rows[1].lost_peer, Role::kVisual);
    EXPECT_THAT(nodes_alive(ports_.base()), testing::IsEmpty());
}

TEST_F(RunByClock, LockStepKeepsWhatWasRecordedUntilCtrlC) {
    Child child = start_into_second_trial();
    child.signal(SIGINT);
    EXPECT_EQ(child.wait(kPatience), 1);
    EXPECT_THAT(words(), HasSubstr("interrupted; finished trials are kept"));
    EXPECT_GE(read_trial_table(out_ / "trials.csv").size(), 2U);
}

}  // namespace
}  // namespace thimble
