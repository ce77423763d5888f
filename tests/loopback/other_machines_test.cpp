// `thimble run` with real processes on "machines" that are shells of this one, reached as ssh would reach them
// (fake_ssh.sh). However a session ends, no process and no file is left behind.
#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/loopback/real_run.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;
using testing::AnyOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

// Begins the rest of a session file, whose last table it is: a test adds keys.
const std::string kShared = std::string(kUnprotectedTable) + "[launch]\nshares_loopback = true\n";

std::string launch_table(const std::string& more = "") {
    return kShared + "machine_netem = 'chatty'\nmachine_slave_sim = 'robot'\nlease_s = 2\n" + more;
}

class OtherMachines : public testing::Test {
  protected:
    OtherMachines() { fs::create_directories(room_); }

    std::vector<std::string> arguments(const fs::path& programs,
                                       const std::vector<std::string>& more = {}) const {
        std::vector<std::string> all{
            "--exec", "sh " THIMBLE_SOURCE_DIR "/tests/loopback/fake_ssh.sh " + room_.string() + " {host}",
            "--programs", programs.string()};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }
    RealRun start(const SessionFile& session, const std::vector<std::string>& more = {}) const {
        return RealRun(session, arguments(programs_, more));
    }
    static SessionFile endless(double contact_hold_s = kEndlessHold_s) {
        SessionFile session = SessionFile::endless(contact_hold_s);
        session.more = launch_table();
        return session;
    }
    // Nodes end, and remove their folders, a moment after the launcher.
    void expect_nothing_left(const RealRun& run) const {
        EXPECT_TRUE(wait_until([&] { return nodes_alive(run.base_port()).empty(); }));
        EXPECT_THAT(nodes_alive(run.base_port()), IsEmpty());
        EXPECT_TRUE(wait_until([&] { return fs::is_empty(room_); })) << "folders of nodes remain";
    }

    Folder folder_;
    fs::path room_ = folder_ / "room";
    fs::path programs_ = built_programs();
};

TEST_F(OtherMachines, ASessionOnThreeMachinesIsARunLikeAnyOther) {
    SessionFile session;
    session.modalities = R"(["CF"])";
    session.more = launch_table();
    RealRun run = start(session);
    ASSERT_EQ(run.end(), 0) << run.words();
    const TrialRow row = run.only_row();
    EXPECT_EQ(row.reason, EndReason::kCompleted);
    EXPECT_TRUE(row.metrics.beeped);
    for (const char* program : kNodePrograms) {
        ASSERT_FALSE(run.report(program).is_null()) << program;
        EXPECT_GT(run.report(program).at("accepted"), 0) << program;
        EXPECT_THAT(read_text(run.out() / "nodes" / (std::string(program) + "_0ms.log")), HasSubstr("ready"));
    }
    for (const std::string program : {"thimble-slave-sim", "thimble-netem", "thimble-master"}) {
        const std::string log = read_text(run.out() / "nodes" / (program + "_0ms.mcap"));
        EXPECT_GT(log.size(), 1000U) << program << ": its log of messages has not come here";
        EXPECT_TRUE(log.ends_with("MCAP0\r\n")) << program << ": not all of it";
        EXPECT_EQ(run.report(program).at("log").at("fault"), "");
    }
    EXPECT_EQ(run.report("thimble-slave-sim").at("machine"), "robot");
    EXPECT_EQ(run.report("thimble-netem").at("machine"), "chatty");
    EXPECT_FALSE(run.report("thimble-master").contains("machine")) << "it ran here";
    EXPECT_THAT(read_text(run.out() / "report.html"), HasSubstr("robot"));
    expect_nothing_left(run);
}

// The datagrams and the grants go another way, the bytes stay.
TEST_F(OtherMachines, LockStepGivesTheBytesOfVirtualTime) {
    SessionFile session;
    session.modalities = R"(["CF"])";
    session.delays_s = "[0.05]";
    session.more = launch_table();
    RealRun run = start(session, kLockStep);
    ASSERT_EQ(run.end(), 0) << run.words();
    EXPECT_EQ(run.report("thimble-slave-sim", 50).at("machine"), "robot");
    EXPECT_THAT(read_text(run.out() / "report.html"), HasSubstr("robot"));
    EXPECT_EQ(whole_text(run.out() / "virtual.csv"), read_text(run.out() / "trials.csv"));
    EXPECT_THAT(read_text(run.out() / "nodes/thimble-slave-sim_50ms.log"), Not(HasSubstr("GRANT_KEY")));
    const fs::path log = run.out() / "nodes/thimble-slave-sim_50ms_trial01.mcap";
    EXPECT_TRUE(read_text(log).ends_with("MCAP0\r\n")) << "its log of messages has not come here";
    EXPECT_EQ(run.report("thimble-slave-sim", 50).at("log").at("file"), log.string());
    EXPECT_FALSE(fs::exists(run.out() / "nodes/thimble-slave-sim_50ms.mcap"));
    expect_nothing_left(run);
}

TEST_F(OtherMachines, LockStepNamesAMachineWhoseNodeDies) {
    RealRun run = start(endless(kEndlessInLockStep_s), kLockStep);
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    kill(run.node("thimble-slave-sim"), SIGKILL);
    EXPECT_EQ(run.end(), 3) << run.words();
    EXPECT_THAT(run.words(), HasSubstr("thimble-slave-sim on 'robot' ended with code 137"));
    EXPECT_EQ(run.only_reason(), EndReason::kPeerLost);
    expect_nothing_left(run);
}

// The network's profile lies beside the session file, in a folder and under a name that a shell could stumble over.
TEST_F(OtherMachines, FilesOfTheSessionComeAlong) {
    const std::string name = "nets/it's $HOME/my net.toml";
    SessionFile session;
    session.modalities = R"(["CF"])";
    session.more = "[netem.force]\nprofile = \"" + name + "\"\n" + launch_table();
    const auto file = folder_.write("session.toml", session.text());
    fs::create_directories((folder_ / name).parent_path());
    static_cast<void>(folder_.write(name, "[down]\nloss = 0.2\n"));
    const PortBlock ports;
    std::vector<std::string> words{"run",         file.string(),
                                   "--out",       (folder_ / "out").string(),
                                   "--base-port", std::to_string(ports.base())};
    for (const std::string& word : arguments(programs_, kLockStep)) words.push_back(word);
    const Outcome outcome = run_thimble(words);
    ASSERT_EQ(outcome.code, 0) << outcome.words;
    const auto report = nlohmann::json::parse(read_text(folder_ / "out/nodes/thimble-netem_0ms.json"));
    EXPECT_EQ(report.at("machine"), "chatty");
    EXPECT_GT(report.at("links").at(1).at("lost"), 0) << "it ran with another network";
}

TEST_F(OtherMachines, ANodeThatDiesEndsTheSessionEverywhere) {
    RealRun run = start(endless());
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    kill(run.node("thimble-slave-sim"), SIGKILL);
    EXPECT_EQ(run.end(), 3) << run.words();
    EXPECT_THAT(run.words(), HasSubstr("thimble-slave-sim on 'robot' ended with code 137"));
    const TrialRow row = run.only_row();
    EXPECT_EQ(outcome_text(row.reason, row.lost_peer), "peer_lost_slave_sim");
    EXPECT_FALSE(run.report("thimble-netem").is_null()) << "the others end in order";
    expect_nothing_left(run);
}

TEST_F(OtherMachines, AKilledLauncherTakesItsNodesAlong) {
    RealRun run = start(endless());
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    EXPECT_EQ(nodes_alive(run.base_port()).size(), kNodePrograms.size());
    run.launcher().signal(SIGKILL);
    EXPECT_EQ(run.end(), 128 + SIGKILL);
    expect_nothing_left(run);
}

TEST_F(OtherMachines, ABrokenConnectionIsToldFromANodeThatEnds) {
    SessionFile session = endless();
    session.more += "machine_visual = 'breaking'\n";
    RealRun run = start(session);
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    static_cast<void>(folder_.write("break", ""));
    EXPECT_EQ(run.end(), 3) << run.words();
    EXPECT_THAT(run.words(), HasSubstr("lost the connection to 'breaking', which thimble-visual ran on"));
    EXPECT_THAT(run.words(), HasSubstr("Broken pipe"));
    expect_nothing_left(run);
}

// As when a cable is pulled: no end of file, no error, nothing.
TEST_F(OtherMachines, NodesEndByThemselvesWhenTheLauncherFallsSilent) {
    RealRun run = start(endless());
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    run.launcher().signal(SIGSTOP);
    EXPECT_TRUE(wait_until([&] { return node_pids(run.base_port(), "thimble-slave-sim").empty(); }));
    EXPECT_TRUE(wait_until([&] { return node_pids(run.base_port(), "thimble-netem").empty(); }));
    EXPECT_TRUE(wait_until([&] { return fs::is_empty(room_); }));
    run.launcher().signal(SIGKILL);
    EXPECT_EQ(run.end(), 128 + SIGKILL);
    expect_nothing_left(run);
}

// thimble waits for logs that come slowly, for all at once, until a signal tells it to end.
TEST_F(OtherMachines, ASignalEndsTheWaitForTheMachinesLastWords) {
    SessionFile session;
    session.modalities = R"(["CF"])";
    session.more = kShared + "machine_netem = 'trickling'\nmachine_visual = 'trickling'\n";
    RealRun run = start(session);
    const std::array<fs::path, 2> logs{run.out() / "nodes/thimble-netem_0ms.mcap",
                                       run.out() / "nodes/thimble-visual_0ms.mcap"};
    const auto exist = [&] { return fs::exists(logs[0]) && fs::exists(logs[1]); };
    ASSERT_TRUE(wait_until([&] { return exist() || run.launcher().poll(); })) << run.words();
    for (const fs::path& log : logs) {
        const auto before = fs::file_size(log);
        EXPECT_TRUE(wait_until([&] { return fs::file_size(log) > before + 50; })) << log;
    }
    run.launcher().signal(SIGTERM);
    EXPECT_EQ(run.end(), 1) << run.words();
    EXPECT_THAT(run.words(), HasSubstr("of 100000000 bytes; a signal ended the wait for the rest"));
    EXPECT_EQ(run.only_reason(), EndReason::kCompleted);
    expect_nothing_left(run);
}

// Something else has the place of one report when its machine sends it. The results of the session stay.
TEST_F(OtherMachines, AReportThatCannotBeWrittenIsNamed) {
    RealRun run = start(endless());
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    fs::create_directories(run.out() / "nodes/thimble-netem_0ms.json");
    run.launcher().signal(SIGINT);
    EXPECT_EQ(run.end(), 1) << run.words();
    EXPECT_THAT(run.words(), HasSubstr("the report of thimble-netem: "));
    EXPECT_THAT(run.words(), HasSubstr("thimble-netem_0ms.json"));
    EXPECT_EQ(run.only_reason(), EndReason::kInterrupted);
    EXPECT_FALSE(run.report("thimble-slave-sim").is_null());
    expect_nothing_left(run);
}

class OtherMachinesFail : public OtherMachines {
  protected:
    OtherMachinesFail() {
        programs_ = folder_ / "bin";
        install_programs(programs_);
    }
    // Of a session that must not come to a trial.
    void expect_end(RealRun& run, int code, const std::string& words) const {
        EXPECT_EQ(run.end(), code) << run.words();
        EXPECT_THAT(run.words(), HasSubstr(words));
        expect_nothing_left(run);
    }
    static SessionFile session(const std::string& launch) {
        SessionFile session;
        session.peer_wait_s = 1;
        session.more = launch;
        return session;
    }
};

TEST_F(OtherMachinesFail, AMachineThatCannotBeReachedIsNamedWithTheCommand) {
    RealRun run = start(session(kShared + "machine_netem = 'robot'\nmachine_visual = 'down'"));
    expect_end(run, 3, "cannot reach 'down' for thimble-visual: 'sh " THIMBLE_SOURCE_DIR);
    EXPECT_THAT(run.words(), HasSubstr("Connection refused"));
}

// It would fill the disk, and go on for ever.
TEST_F(OtherMachinesFail, AMachineThatDoesNotStopTalkingIsCutOff) {
    RealRun run = start(session(kShared + "machine_netem = 'flooding'"));
    expect_end(run, 3, "lost 'flooding' while thimble-netem ran there: it sends more than 1048576 bytes");
    RealRun check = start(session(kShared + "machine_netem = 'flooding'"), {"--check"});
    EXPECT_EQ(check.end(), 3) << check.words();
    EXPECT_THAT(check.words(), HasSubstr("sends more than 1048576 bytes"));
}

struct BadMachine {
    const char* name;
    const char* slave_sim;  // a script in its place; empty: it is not there
    const char* launch;
    int code;
    const char* words;
};
class OtherMachinesFailBy : public OtherMachinesFail, public testing::WithParamInterface<BadMachine> {};
INSTANTIATE_TEST_SUITE_P(
    Slave, OtherMachinesFailBy,
    testing::Values(BadMachine{"Silence", "exit 1", "machine_slave_sim = 'mute'\nreach_s = 1\n", 3,
                               "'mute', where thimble-slave-sim should run, does not answer"},
                    BadMachine{"AMissingProgram", "", "machine_slave_sim = 'robot'\n", 1,
                               "thimble-slave-sim is not on 'robot'"},
                    BadMachine{"AnotherVersion", "echo 9.8.7", "machine_slave_sim = 'robot'\n", 1,
                               "thimble-slave-sim on 'robot' is 9.8.7, but this is " THIMBLE_VERSION}),
    [](const auto& bad) { return bad.param.name; });

TEST_P(OtherMachinesFailBy, OneMachineWhichIsNamed) {
    fs::remove(programs_ / "thimble-slave-sim");
    if (*GetParam().slave_sim != 0) replace_program(programs_ / "thimble-slave-sim", GetParam().slave_sim);
    RealRun run = start(session(kShared + GetParam().launch));
    expect_end(run, GetParam().code, GetParam().words);
}

TEST_F(OtherMachinesFail, AStopThatComesWhileAMachineIsAwaitedIsKept) {
    RealRun run = start(session(kShared + "reach_s = 2\nmachine_slave_sim = 'mute'"));
    ASSERT_TRUE(wait_until([&] { return run.words().find("round trip") != std::string::npos; }))
        << run.words();
    run.launcher().signal(SIGQUIT);
    expect_end(run, 3, "'mute', where thimble-slave-sim should run, does not answer");
    EXPECT_FALSE(fs::is_empty(std::getenv("THIMBLE_STOP_DIR")));
}

TEST_F(OtherMachinesFail, ABadSessionStartsNothing) {
    RealRun alone = start(session("[launch]\nmachine_netem = 'robot'"));
    expect_end(alone, 2, "127.0.0.1");
    RealRun without_key = start(session("[launch]\nshares_loopback = true\nmachine_netem = 'robot'"));
    expect_end(without_key, 2, "thimble keygen");
    const auto trace = folder_.write("elsewhere.csv", "time_s,delay_s\n0,0.01\n1,0.01\n");
    SessionFile traced = session("[netem.force]\ntrace = '" + trace.string() + "'\n" + launch_table());
    traced.delays_s.clear();
    RealRun elsewhere = start(traced);
    expect_end(elsewhere, 2, trace.string());
}

TEST_F(OtherMachinesFail, AWayThereThatDoesNotExistIsNamed) {
    const std::vector<std::string> exec{"--exec", "/no/such/ssh {host}"};
    RealRun run(session(launch_table()), exec);
    expect_end(run, 1, "cannot start /no/such/ssh");
    EXPECT_THAT(run.words(), HasSubstr("--exec"));
}

TEST_F(OtherMachinesFail, ACheckLooksAtEveryMachineAndStartsNothing) {
    replace_program(programs_ / "thimble-visual", "echo 9.8.7");
    RealRun bad =
        start(session(launch_table("machine_visual = 'eyes'\nmachine_cutaneous = 'down'\n")), {"--check"});
    EXPECT_THAT(bad.end(), AnyOf(1, 3));
    EXPECT_THAT(bad.words(), HasSubstr("thimble-slave-sim on robot: good"));
    EXPECT_THAT(bad.words(), HasSubstr("9.8.7"));
    EXPECT_THAT(bad.words(), HasSubstr("cannot reach 'down'"));
    EXPECT_FALSE(fs::exists(bad.out() / "trials.csv"));
    RealRun good = start(session(launch_table()), {"--check", "--json"});
    EXPECT_EQ(good.end(), 0) << good.words();
    const auto verdicts = nlohmann::json::parse(good.words());
    EXPECT_EQ(verdicts.at("thimble-slave-sim").at("machine"), "robot");
    EXPECT_EQ(verdicts.at("thimble-slave-sim").at("problem"), "");
    expect_nothing_left(good);
}

TEST_F(OtherMachinesFail, PrintsUnitsAndPortsInstead) {
    RealRun units = start(session(launch_table()), {"--print", "systemd"});
    EXPECT_EQ(units.end(), 0) << units.words();
    EXPECT_THAT(read_text(units.out() / "robot/thimble-slave-sim.service"), HasSubstr("Type=notify"));
    RealRun ports = start(session(launch_table()), {"--print", "ports"});
    EXPECT_EQ(ports.end(), 0);
    EXPECT_THAT(ports.words(), HasSubstr("| slave_sim | netem | needle |"));
    EXPECT_THAT(ports.words(), Not(HasSubstr("| percepts |"))) << "these stay on this machine";
}

}  // namespace
}  // namespace thimble
