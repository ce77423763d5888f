// The real programs with a held terminal, a full pipe and closed descriptors.
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <stdexcept>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/loopback/real_run.hpp"

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

// A pipe without room: its reader never reads.
class FullPipe {
  public:
    explicit FullPipe(const std::filesystem::path& file)
        : path_(file.string()),
          made_(mkfifo(path_.c_str(), 0600)),
          ends_(open(path_.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC)) {
        if (made_ != 0 || ends_ < 0) throw std::runtime_error("no pipe");
        while (write(ends_, "full", 4) == 4) {
        }
    }
    ~FullPipe() { close(ends_); }
    FullPipe(const FullPipe&) = delete;
    FullPipe& operator=(const FullPipe&) = delete;
    const std::string& name() const { return path_; }

  private:
    std::string path_;
    int made_, ends_;
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
    const auto rows = run.rows();
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(outcome_text(rows.front().reason, rows.front().lost_peer), "interrupted");
}

TEST_F(StandardStreams, APipeThatNobodyReadsHoldsUpNoRun) {
    const FullPipe pipe(folder_ / "pipe");
    RealRun run(SessionFile{}, {}, programs(">/dev/null 2>" + pipe.name()));
    expect_end(run, 0, EndReason::kCompleted);
}

// As cron, daemons and `2>&-` start programs.
TEST_F(StandardStreams, WhereTheyAreClosedNoTableGetsTheWords) {
    for (const std::string& closed : std::vector<std::string>{"2>&-", "<&- >&- 2>&-"}) {
        const auto out = folder_ / ("out" + std::to_string(closed.size()));
        const std::string study = "exec '" + (built_programs() / "thimble").string() +
                                  "' study --experiment 2 --subjects 2 --out '" + out.string() + "' ";
        EXPECT_EQ(run_to_end("/bin/sh", {"-c", study + closed}).code, 0);
        EXPECT_THAT(read_text(out / "trials.csv"), Not(HasSubstr("trials in"))) << closed;
        EXPECT_EQ(read_trial_table(out / "trials.csv").size(), 4U) << closed;
    }
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

}  // namespace
}  // namespace thimble
