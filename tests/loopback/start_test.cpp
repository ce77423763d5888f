// Starting: help, configuration, ports, missing programs. A bad start ends at once and says what is wrong and
// where.
#include <algorithm>
#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/loopback/lone_node.hpp"
#include "tests/loopback/real_run.hpp"

namespace thimble {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> six_programs() {
    std::vector<std::string> programs(kNodePrograms.begin(), kNodePrograms.end());
    programs.emplace_back("thimble");
    return programs;
}

TEST(Help, IsThereWithAnExampleInEveryProgram) {
    for (const std::string& program : six_programs()) {
        const Outcome outcome = run_to_end(built_programs() / program, {"--help"});
        EXPECT_EQ(outcome.code, 0) << program;
        EXPECT_THAT(outcome.words, HasSubstr("Example")) << program;
    }
    for (const char* command : {"run", "study", "replay", "report", "check", "doctor", "keygen"}) {
        const Outcome outcome = run_thimble({command, "--help"});
        EXPECT_EQ(outcome.code, 0) << command;
        EXPECT_THAT(outcome.words, HasSubstr("Example")) << command;
    }
}

TEST(Help, HelpAndVersionAreWordsTooAndCommandsAreGroupedByPurpose) {
    const std::string help = run_thimble({"--help"}).words;
    EXPECT_EQ(run_thimble({"help"}).words, help);
    EXPECT_EQ(run_thimble({"help", "log", "check"}).words, run_thimble({"log", "check", "--help"}).words);
    EXPECT_EQ(run_thimble({"version"}).words, run_thimble({"--version"}).words);
    const std::size_t study = help.find("\nStudy:"), people = help.find("\nPeople:");
    ASSERT_LT(study, people);
    EXPECT_THAT(help.substr(study, people - study), HasSubstr("\n  analyse "));
}

TEST(Help, AnUnknownOptionIsAUsageError) {
    for (const std::string& program : six_programs()) {
        EXPECT_EQ(run_to_end(built_programs() / program, {"--no-such-option"}).code, 2) << program;
    }
}

// CLI11 would read -1 as 2^64 - 1, 010 as 8, and let nan through every range.
TEST(Help, NumbersThatAreNoneAreUsageErrors) {
    const std::vector<std::vector<std::string>> refused{
        {"thimble", "study", "--seed", "-1"},
        {"thimble", "study", "--seed", "010"},
        {"thimble", "study", "--seed", "18446744073709551616"},
        {"thimble", "board", "--seed", "9223372036854775808"},
        {"thimble", "study", "--subjects", "-1"},
        {"thimble", "study", "--jobs", "-1"},
        {"thimble", "study", "--jobs", "-18446744073709551615"},
        {"thimble", "study", "--seeds", "-1"},
        {"thimble", "study", "--draws", "-1"},
        {"thimble", "sweep", "--seed", "-1"},
        {"thimble", "sweep", "--trials", "-1"},
        {"thimble", "sweep", "--block", "-1"},
        {"thimble", "compensators", "--seed", "-1"},
        {"thimble", "compensators", "--jobs", "-1"},
        {"thimble", "dataset", "exclude", "--trial", "-1"},
        {"thimble", "play", "--trial", "-1"},
        {"thimble", "link-test", "--ports", "-1"},
        {"thimble", "stop", "--base-port", "027000"},
        {"thimble", "stop", "--parallel-conditions", "010"},
        {"thimble", "doctor", "--seconds", "nan"},
        {"thimble", "play", "--seconds", "1e10"},
        {"thimble", "stability", "--mass-kg", "inf"},
        {"thimble", "stability", "--mass-kg", ""},
        {"thimble", "report", "--out", ""},
        {"thimble-netem", "--to=lab:1", "--seed", "-1"},
        {"thimble-netem", "--to=lab:1", "--max-flows", "-1"},
    };
    for (const std::vector<std::string>& words : refused) {
        const std::string typed = words[words.size() - 2] + ": ";
        const Outcome outcome = run_to_end(built_programs() / words[0], {words.begin() + 1, words.end()});
        EXPECT_EQ(outcome.code, 2) << words[1] << ' ' << typed << outcome.words;
        EXPECT_THAT(outcome.words, AllOf(HasSubstr(typed),
                                         ContainsRegex("not in range .* to |at most [19]|finite|is empty")));
    }
}

// bash's completions of a command line whose last word is incomplete.
std::string completed(const std::string& program, const std::string& words) {
    const std::string path = "'" + (built_programs() / program).string() + "'";
    std::string function = "_complete_" + program;
    std::replace(function.begin(), function.end(), '-', '_');
    const std::string script = "eval \"$(" + path + " --completion bash)\"; COMP_WORDS=(" + path + " " +
                               words + "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); " + function +
                               "; echo ${COMPREPLY[*]}";
    return run_to_end("/bin/bash", {"-c", script}).words;
}

TEST(Completion, KnowsSubcommandsOptionsAndChoices) {
    EXPECT_EQ(completed("thimble", "st"), "stop study stability\n");
    EXPECT_EQ(completed("thimble", "log re"), "repair\n");
    EXPECT_EQ(completed("thimble", "run --over"), "--overwrite\n");
    EXPECT_EQ(completed("thimble", "study --order ''"), "shuffled williams\n");
    EXPECT_EQ(completed("thimble", "study --order = w"), "williams\n");
    EXPECT_EQ(completed("thimble", "study --order=w"), "--order=williams\n");
    EXPECT_EQ(completed("thimble", "completion z"), "zsh\n");
    EXPECT_EQ(completed("thimble", "run --out st"), "\n");  // a file's name: the shell's own business
    EXPECT_EQ(completed("thimble-netem", "--max"), "--max-flows\n");
}

TEST(Completion, IsInEveryProgramForEveryShell) {
    for (const std::string& program : six_programs()) {
        for (const char* shell : {"bash", "zsh", "fish"}) {
            const Outcome outcome = run_to_end(built_programs() / program, {"--completion", shell});
            EXPECT_EQ(outcome.code, 0) << program;
            EXPECT_THAT(outcome.words, HasSubstr("Completion of " + program + " for " + shell));
        }
    }
    EXPECT_EQ(run_thimble({"completion", "csh"}).code, 2);
    EXPECT_EQ(run_thimble({"--completion", "csh"}).code, 2);
}

// Every program reads [network] and [runtime]; each also has a table of its own.
class BadConfiguration : public testing::Test {
  protected:
    // In the words of one start: all of `places`.
    void expect_refused(const std::string& program, const std::string& text,
                        const std::vector<std::string>& places) {
        const auto file = folder_.write("bad.toml", text);
        std::vector<std::string> arguments{file.string(), "--base-port", std::to_string(ports_.base())};
        if (program == "thimble") arguments = {"run", file.string(), "--out", (folder_ / "out").string()};
        const Outcome outcome = run_to_end(built_programs() / program, arguments);
        EXPECT_EQ(outcome.code, 2) << program << ": " << outcome.words;
        for (const std::string& place : places)
            EXPECT_THAT(outcome.words, HasSubstr(file.string() + place)) << program;
    }
    Folder folder_;
    PortBlock ports_;
};

// Also before a device is opened: the second mistake would keep the master from its handle.
TEST_F(BadConfiguration, AllMistakesAreSaidAtOnce) {
    for (const std::string& program : six_programs()) {
        expect_refused(program, "\n[netwrok]\nbase_port = 2000\n", {":2:"});
        expect_refused(program,
                       "[runtime]\npriority = 0\ncore = 'x'\n[network]\nport = 2000\nbase_port = 80\n",
                       {" has 4 errors:", ":2:12: 'runtime.priority' is 0", ":3:8: 'runtime.core'",
                        ":5:8: unknown key 'network.port': did you mean 'base_port'", ":6:13:"});
    }
    expect_refused("thimble-master", "[handle]\ndevice = 'falcon'\n[master]\nposition_scale = 0\n",
                   {":4:18:"});
    expect_refused("thimble-netem", "[netem.force]\ndelay_s = '5 xs'\nloss = 2\n", {":3:8:"});
}

TEST_F(BadConfiguration, ValueOutOfRangeInTheProgramsOwnTable) {
    expect_refused("thimble-netem", "[netem.force]\nloss = 1.5\n", {":2:"});
    expect_refused("thimble-slave-sim", "[tissue]\n\nmass_kg = -1\n", {":3:"});
    expect_refused("thimble-cutaneous", "[cutaneous]\nforce_limit_N = -1\n", {":2:"});
    expect_refused("thimble-visual", "[visual]\nrefresh_Hz = 0\n", {":2:"});
    expect_refused("thimble-master", "[master]\nposition_scale = 0\n", {":2:"});
    expect_refused("thimble", "[session]\n\n\ndelays_s = [0.0, -1.0]\n", {":4:"});
}

// Before a folder is written, and not in the log of a window that then does not open.
TEST(Configuration, LettersThatTheWindowsFontLacksAreNamed) {
    if (run_to_end(built_programs() / "thimble-visual", {"--help"}).words.find("--window") ==
        std::string::npos)
        GTEST_SKIP() << "this build has no windows (THIMBLE_GUI is off)";
    const Folder folder;
    const std::string file =
        folder.write("letters.toml", "[instructions]\nready = \"\U00013000\"\n").string();
    const std::string out = (folder / "out").string();
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"check", file}, {"run", file, "--out", out}}) {
        const Outcome outcome = run_thimble(command);
        EXPECT_EQ(outcome.code, 2);
        EXPECT_THAT(outcome.words,
                    HasSubstr("the window's font has no characters for these in [instructions]: U+13000"));
    }
    EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(Configuration, OptionsOfAWindowNeedOne) {
    const PortBlock ports;
    for (const char* words : {"--screenshot last.png", "--fullscreen", "--view subject"}) {
        const Outcome outcome = run_to_end(built_programs() / "thimble-visual",
                                           words_in(words, {"--base-port", std::to_string(ports.base())}));
        EXPECT_EQ(outcome.code, 2) << words << ' ' << outcome.words;
    }
}

// Of the session's own ports and of a node's, in the words of the program that could not listen.
TEST(PortInUse, ARunSaysWhichPort) {
    for (const Port taken : {Port::kSessionRecord, Port::kSlaveNeedle}) {
        const PortBlock ports;
        const Folder folder;
        const NetworkSettings network = network_at(ports.base());
        const UdpChannel occupant(network.at(taken), {"127.0.0.1", 0});
        std::vector<std::string> run{"run",         folder.write("s.toml", SessionFile{}.text()).string(),
                                     "--out",       (folder / "out").string(),
                                     "--base-port", std::to_string(ports.base())};
        const Outcome outcome = run_thimble(run);
        EXPECT_EQ(outcome.code, 3);
        EXPECT_THAT(outcome.words, HasSubstr("127.0.0.1:" + std::to_string(network.at(taken).port)));
        EXPECT_THAT(nodes_alive(ports.base()), IsEmpty());
        if (taken != Port::kSessionRecord) continue;
        run.insert(run.end(), {"--clock", "virtual"});
        EXPECT_EQ(run_thimble(run).code, 0) << "the folder of a start that failed may be used again";
    }
}

class MissingPeer : public testing::Test {
  protected:
    MissingPeer() { install_programs(programs_); }

    void expect_end(RealRun& run, const std::string& words) const {
        EXPECT_EQ(run.end(), 3);
        EXPECT_THAT(run.words(), HasSubstr(words));
        EXPECT_THAT(nodes_alive(run.base_port()), IsEmpty());
    }
    // Before the nodes have all answered.
    static SessionFile waiting(double peer_wait_s) {
        SessionFile session;
        session.peer_wait_s = peer_wait_s;
        return session;
    }

    Folder folder_;
    std::filesystem::path programs_ = folder_ / "bin";
};

TEST_F(MissingPeer, AProgramThatIsNotThereIsNamed) {
    std::filesystem::remove(programs_ / "thimble-cutaneous");
    RealRun run(SessionFile{}, {}, programs_);
    EXPECT_THAT(run.end(), AnyOf(1, 3));
    EXPECT_THAT(run.words(), HasSubstr("cannot start " + (programs_ / "thimble-cutaneous").string()));
    EXPECT_THAT(nodes_alive(run.base_port()), IsEmpty());
}

TEST_F(MissingPeer, AProgramThatEndsAtOnceIsQuoted) {
    replace_program(programs_ / "thimble-master", "echo the handle is unplugged; exit 5");
    RealRun run(SessionFile{}, {}, programs_);
    expect_end(run, "thimble-master ended with code 5: the handle is unplugged");
}

TEST_F(MissingPeer, AProgramThatNeverAnswersIsNamed) {
    replace_program(programs_ / "thimble-visual", "exec sleep 60");
    RealRun run(waiting(1), {}, programs_);
    expect_end(run, "no answer from ");
    EXPECT_THAT(run.words(), HasSubstr("visual"));
}

// The silent fifth program keeps the run waiting for its first trial while another one dies.
TEST_F(MissingPeer, KilledBeforeTheFirstTrial) {
    replace_program(programs_ / "thimble-visual", "exec sleep 60");
    RealRun run(waiting(30), {}, programs_);
    kill(run.node("thimble-slave-sim"), SIGKILL);
    expect_end(run, "thimble-slave-sim ended with code 137");
}

}  // namespace
}  // namespace thimble
