// Messages without a reader. Each test forks: descriptors belong to a whole process.
#include "common/runtime/standard_streams.hpp"

#include <array>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <string>
#include <unistd.h>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/process/child.hpp"
#include "common/runtime/node_program.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// In the place of stderr: a pipe with no room left. Returns the end to read from.
int fill_stderr() {
    alarm(20);  // a write that blocks would never return
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) std::exit(99);
    fcntl(ends[1], F_SETFL, O_NONBLOCK);
    while (write(ends[1], "full", 4) == 4) {
    }
    fcntl(ends[1], F_SETFL, 0);
    dup2(ends[1], STDERR_FILENO);
    return ends[0];
}

std::string read_until(int from, const std::string& words) {
    std::string text;
    for (std::array<char, 4096> chunk{}; text.find(words) == std::string::npos;) {
        const ssize_t n = read(from, chunk.data(), chunk.size());
        if (n <= 0) return text;
        text.append(chunk.data(), static_cast<std::size_t>(n));
    }
    return text;
}

// More than the queue takes: the first ones, then their number, then what came later.
int say_too_much() {
    const int reader = fill_stderr();
    constexpr int kLines = 3000;
    for (int i = 0; i < kLines; ++i) write_stderr(fmt::format("line {:060}\n", i));
    if (stderr_written_within(milliseconds{20})) return 2;
    const std::string text = read_until(reader, "are missing here");
    if (text.find(fmt::format("line {:060}\n", 0)) == std::string::npos) return 3;
    if (text.find(fmt::format("line {:060}\n", kLines - 1)) != std::string::npos) return 4;
    write_stderr("later\n");
    if (read_until(reader, "later\n").find("later\n") == std::string::npos) return 5;
    return stderr_written_within(seconds{20}) ? 0 : 6;
}

TEST(StandardStreamsDeathTest, WhoeverSpeaksToAFullPipeDoesNotWaitAndWhatIsMissingIsCounted) {
    EXPECT_EXIT(std::exit(say_too_much()), testing::ExitedWithCode(0), "");
}

TEST(StandardStreamsDeathTest, AProgramWhoseWordsNobodyReadsEndsWithItsOwnCode) {
    EXPECT_EXIT(
        {
            fill_stderr();
            std::exit(guarded_main("test", [] {
                for (int i = 0; i < 3000; ++i) spdlog::warn("{:060}", i);
                return 3;
            }));
        },
        testing::ExitedWithCode(3), "");
}

TEST(StandardStreamsDeathTest, WhatIsSaidLastIsWrittenBeforeTheEnd) {
    EXPECT_EXIT(std::exit(guarded_main("test",
                                       []() -> int {
                                           spdlog::warn("careful");
                                           throw Error(ExitCode::kData, "broken");
                                       })),
                testing::ExitedWithCode(5), "test: warning: careful\ntest: error: broken\n");
}

// As cron, daemons and `2>&-` start programs: the next file would be standard error.
TEST(StandardStreamsDeathTest, NoFileTakesTheNumberOfAClosedOne) {
    EXPECT_EXIT(
        {
            for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) close(descriptor);
            std::exit(guarded_main("test", [] {
                const int file = open("/dev/null", O_WRONLY | O_CLOEXEC);
                char byte = 0;
                const bool empty = read(STDIN_FILENO, &byte, 1) == 0;
                const bool taken = write(STDOUT_FILENO, "x", 1) == 1 && write(STDERR_FILENO, "x", 1) == 1;
                return file > STDERR_FILENO && empty && taken ? 0 : 1;
            }));
        },
        testing::ExitedWithCode(0), "");
}

TEST(StandardStreamsDeathTest, AnOpenOneStaysWhatItWas) {
    EXPECT_EXIT(
        std::exit(guarded_main("test", [] { return write(STDERR_FILENO, "as before", 9) == 9 ? 0 : 1; })),
        testing::ExitedWithCode(0), "as before");
}

TEST(GuardedMainDeathTest, AParentThatIgnoresSigchldHidesNoFailureOfAChild) {
    EXPECT_EXIT(
        {
            std::signal(SIGCHLD, SIG_IGN);
            std::exit(guarded_main("test", [] { return run_program("false", {}, ".", "").exit_code; }));
        },
        testing::ExitedWithCode(1), "");
}

}  // namespace
}  // namespace thimble
