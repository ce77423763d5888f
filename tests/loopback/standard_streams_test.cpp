// The real programs with a held terminal, a full pipe and closed descriptors.
#include <csignal>
#include <fcntl.h>
#include <stdexcept>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/loopback/programs.hpp"
#include "tests/loopback/real_run.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;
using testing::Not;

// A pseudo-terminal, as a terminal's window has it.
class HeldTerminal {
  public:
    HeldTerminal() : window_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
        if (window_ < 0 || grantpt(window_) != 0 || unlockpt(window_) != 0)
            throw std::runtime_error("no pseudo-terminal");
    }
    ~HeldTerminal() { close(window_); }
    HeldTerminal(const HeldTerminal&) = delete;
    HeldTerminal& operator=(const HeldTerminal&) = delete;

    std::string name() const { return ptsname(window_); }  // NOLINT(concurrency-mt-unsafe): one thread
    bool press(char control) const { return write(window_, &control, 1) == 1; }

  private:
    int window_;
};

class StandardStreams : public testing::Test {
  protected:
    // `thimble` with these redirections.
    std::filesystem::path programs(const std::string& redirections) const {
        auto place = folder_ / "bin";
        install_programs(place);
        replace_program(place / "thimble",
                        "exec " + (built_programs() / "thimble").string() + " \"$@\" " + redirections);
        return place;
    }

    Folder folder_;
};

// Ctrl-S: the trial goes on, and Ctrl-C is heard. (In a real terminal Ctrl-C also ends Ctrl-S. Here the terminal is held to the end.)
TEST_F(StandardStreams, AHeldTerminalHoldsUpNoTrial) {
    const HeldTerminal terminal;
    SessionFile session = SessionFile::endless();
    RealRun run(session, {}, programs(">/dev/null 2>" + terminal.name()));
    ASSERT_TRUE(run.reaches_trial());
    constexpr char kCtrlS = 'S' - '@';
    ASSERT_TRUE(terminal.press(kCtrlS));
    std::this_thread::sleep_for(std::chrono::seconds{1});  // two lines of progress
    run.launcher().signal(SIGINT);
    EXPECT_EQ(run.end(), 1);
    const TrialRow row = run.only_row();
    EXPECT_EQ(outcome_text(row.reason, row.lost_peer), "interrupted");
}

TEST_F(StandardStreams, WhereTheyAreClosedNoSocketOfANodeTakesTheirNumbers) {
    const PortBlock ports;
    for (const char* program : kNodePrograms) {
        const std::string node = "exec '" + (built_programs() / program).string() + "' --base-port " +
                                 std::to_string(ports.base()) + " <&- >&- 2>&-";
        const Child child("/bin/sh", {"-c", node}, folder_ / "words");
        const auto open_at = [&](int descriptor) {
            std::error_code closed;
            return std::filesystem::read_symlink(std::filesystem::path("/proc") /
                                                     std::to_string(child.pid()) / "fd" /
                                                     std::to_string(descriptor),
                                                 closed);
        };
        // Once it has opened something of its own, those below are there.
        ASSERT_TRUE(
            wait_until([&] { return !node_pids(ports.base(), program).empty() && !open_at(5).empty(); }));
        for (const int descriptor : {0, 1, 2}) EXPECT_EQ(open_at(descriptor), "/dev/null") << program;
    }
}

// Where results go: a standard output that loses them, a folder that cannot be made, a name that is no UTF-8.
std::string built(const char* program) { return "'" + (built_programs() / program).string() + "'"; }

// A line of bash. Its exit code is that of the first program in the pipe.
Outcome in_bash(const std::string& line) {
    return run_to_end("/bin/bash", {"-c", line + "; exit ${PIPESTATUS[0]}"});
}

class Outputs : public testing::Test {
  protected:
    std::vector<std::string> commands() const {
        const std::string study = built("thimble") +
                                  " study --experiment 2 --subjects 1 --overwrite --out '" +
                                  (folder_ / "out").string() + "'";
        const std::string theory = built("thimble") +
                                   " stability --mass-kg 1 --damping-Ns-per-m 20 --stiffness-N-per-m 500 "
                                   "--contact-stiffness-N-per-m 9000";
        return {study,
                study + " --json",
                built("thimble") + " check '" + session_.string() + "'",
                built("thimble") + " config reference --json",
                theory,
                theory + " --json",
                built("thimble") + " completion bash",
                built("thimble") + " doctor",
                built("thimble") + " study --help",
                built("thimble-netem") + " --version",
                built("thimble-master") + " --help",
                built("thimble-drive-emulator") + " --help"};
    }
    Folder folder_;
    std::filesystem::path session_ = folder_.write("session.toml", SessionFile{}.text());
};

TEST_F(Outputs, LostResultsAreNotSuccess) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full";
    for (const std::string& command : commands()) {
        const Outcome lost = in_bash(command + " > /dev/full");
        EXPECT_NE(lost.code, 0) << command;
        EXPECT_THAT(lost.words, HasSubstr("so results are lost")) << command;
        EXPECT_THAT(lost.words, Not(HasSubstr("unexpected"))) << command;
    }
    EXPECT_EQ(in_bash(commands()[1] + " > /dev/full").code, 1);
    EXPECT_EQ(in_bash(commands()[1] + " > /dev/null").code, 0);
}

// As `head` leaves: it has what it wanted, and the study is whole.
TEST_F(Outputs, AReaderThatHasLeftGetsNoMessage) {
    // A pipe whose only reader is closed before the program writes.
    const std::string pipe = "'" + (folder_ / "pipe").string() + "'";
    const std::string without_reader = fmt::format("exec 3<>{0} 4>{0} 3>&- && ", pipe);
    ASSERT_EQ(in_bash("mkfifo " + pipe).code, 0);
    for (const std::string& command : commands()) {
        const Outcome left = in_bash(without_reader + command + " >&4 4>&-");
        EXPECT_NE(left.code, 0) << command;
        EXPECT_LE(left.code, 5) << command;
        EXPECT_THAT(left.words, Not(HasSubstr("results are lost"))) << command;
        EXPECT_THAT(left.words, Not(HasSubstr("unexpected"))) << command;
    }
    EXPECT_TRUE(std::filesystem::exists(folder_ / "out/summary.json"));
}

TEST_F(Outputs, ANameThatIsNoUtf8IsWrittenAsFarAsItGoes) {
    const std::string out = (folder_ / "caf\xe9").string();
    const Outcome study =
        run_thimble({"study", folder_.write("s\xe9.toml", "[session]\ndelays_s = [0.0]\n").string(),
                     "--subjects", "1", "--out", out});
    EXPECT_EQ(study.code, 0) << study.words;
    const auto summary = nlohmann::json::parse(read_text(std::filesystem::path(out) / "summary.json"));
    EXPECT_THAT(summary["provenance"]["command"].get<std::string>(), HasSubstr("s\xef\xbf\xbd.toml"));
}

}  // namespace
}  // namespace thimble
