// The script, in a real shell, with programs that are shell scripts themselves. tests/loopback/up_test.cpp has its effect on real nodes.
#include "session/launch/remote_script.hpp"

#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "common/process/child.hpp"
#include "common/runtime/wall_clock.hpp"
#include "session/launch/remote_shell.hpp"
#include "tests/read_text.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

class RemoteScript : public testing::Test {
  protected:
    RemoteScript() { fs::create_directories(folder_ / "tmp"); }

    void program(const std::string& script) const {
        write_text(folder_ / "node",
                   "#!/bin/sh\n[ \"$1\" != --version ] || { echo 1.2.3; exit; }\n" + script);
        fs::permissions(folder_ / "node", fs::perms::owner_all);
    }
    RemoteOrder order() const {
        RemoteOrder order;
        order.program = "node";
        order.folder = folder_.path();
        order.version = "1.2.3";
        order.machine = "it's lab 2";
        order.session = "a 'b'.toml";
        order.lease = std::chrono::milliseconds{500};
        return order;
    }
    // The script comes first; `then` is what a launcher would send after kSend, in shell words.
    ProgramResult run(const RemoteOrder& order, const std::string& then) const {
        write_text(folder_ / "script", remote_script(order));
        return run_program(
            "sh",
            {"-c", "{ cat script; sleep 0.2; " + then + "; } | TMPDIR=" + (folder_ / "tmp").string() + " sh"},
            folder_.path(), "install a shell");
    }
    int waited() const { return std::stoi(read_text(folder_ / "waited")); }  // turns of kUntilEnded
    bool left_nothing() const { return fs::is_empty(folder_ / "tmp"); }

    const TemporaryDirectory folder_;
};

constexpr const char* kSession = R"(printf "5 a 'b'.toml\nx = 1end\n"; sleep 0.4)";
// The launcher's end stays open, and says no more, until the program has written `ended`; half a minute at most.
constexpr const char* kUntilEnded =
    "; i=0; until [ -e ended ] || [ $i = 600 ]; do sleep 0.05; i=$((i + 1)); done; echo $i >waited";

TEST_F(RemoteScript, StartsTheProgramWithWhatWasSent) {
    program(R"(cat "$1"; echo " with $5" >&2; echo '{"good": true}' > "$3"; exit 4)");
    RemoteOrder with = order();
    with.arguments = {"$(id) 'quoted'"};
    const ProgramResult result = run(with, kSession);
    EXPECT_EQ(result.exit_code, 4) << "the node's own";
    EXPECT_THAT(result.output, HasSubstr("x = 1"));
    EXPECT_THAT(result.output, HasSubstr("with $(id) 'quoted'"));
    EXPECT_THAT(result.output, HasSubstr("thimble: report\n{\"good\": true}"));
    EXPECT_TRUE(left_nothing());
}

TEST_F(RemoteScript, SendsTheLogOfMessagesAfterTheReport) {
    program(R"([ "$5" = --log ] && printf 'log of %s' "$7" > "$6"; echo '{}' > "$3"; exit 3)");
    RemoteOrder with = order();
    with.arguments = {"it"};
    EXPECT_THAT(run(with, kSession).output, HasSubstr("thimble: ended 3 0\n"));
    with.messages = true;
    const ProgramResult result = run(with, kSession);
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_THAT(result.output, HasSubstr("thimble: report\n{}\n\nthimble: ended 3 9\nlog of it"));
    EXPECT_TRUE(left_nothing());
}

TEST_F(RemoteScript, SendsTheLogOfEachTrialOfLockStep) {
    program(
        R"(log=${6%.mcap}; printf one > "${log}_trial01.mcap"; printf 'the second' > "${log}_trial02.mcap")");
    RemoteOrder with = order();
    with.messages = true;
    EXPECT_THAT(run(with, kSession).output, HasSubstr("thimble: ended 0 01 3 02 10 13\nonethe second"));
}

// Where nothing comes for the lease, as with a pulled cable: no end of file, but no lines either. Or where its input ends.
TEST_F(RemoteScript, EndsTheProgram) {
    program("trap 'echo told to end >&2; : >ended; exit 0' TERM\nwhile :; do sleep 0.05; done");
    for (const std::string& then : {std::string(kSession) + kUntilEnded, std::string(kSession)}) {
        EXPECT_THAT(run(order(), then).output, HasSubstr("told to end"));
        EXPECT_TRUE(left_nothing());
    }
    EXPECT_LT(waited(), 600);
}

// One sign, early in the lease: the lease begins with it, and not where the one before would have ended.
TEST_F(RemoteScript, ASilentLauncherIsGivenUpAboutALeaseAfterItsLastSign) {
    program("trap 'date +%s >ended; exit 0' TERM\nwhile :; do sleep 0.05; done");
    RemoteOrder with = order();
    with.lease = std::chrono::seconds{3};
    run(with, R"(printf "5 a 'b'.toml\nx = 1end\n\n"; date +%s >signed)" + std::string(kUntilEnded));
    const int silent_s = std::stoi(read_text(folder_ / "ended")) - std::stoi(read_text(folder_ / "signed"));
    EXPECT_GE(silent_s, 2);
    EXPECT_LE(silent_s, 4);
    EXPECT_LT(waited(), 600);
}

TEST_F(RemoteScript, KillsAProgramThatDoesNotListen) {
    program("trap '' TERM\nwhile :; do sleep 0.05; done");
    EXPECT_EQ(run(order(), kSession).exit_code, 128 + 9);
    EXPECT_TRUE(left_nothing());
}

TEST_F(RemoteScript, SaysWhatIsMissing) {
    const ProgramResult absent = run(order(), "true");
    EXPECT_EQ(absent.exit_code, kNoProgram);
    EXPECT_THAT(absent.output, HasSubstr("is not on 'it's lab 2'"));
    program("exit 0");
    RemoteOrder newer = order();
    newer.version = "1.2.4";
    const ProgramResult other = run(newer, "true");
    EXPECT_EQ(other.exit_code, kOtherVersion);
    EXPECT_THAT(other.output, HasSubstr("is 1.2.3, but this is 1.2.4"));
    EXPECT_TRUE(left_nothing());
}

TEST_F(RemoteScript, StartsNothingWithHalfOfTheFiles) {
    program("echo started >&2");
    const ProgramResult result = run(order(), R"(printf "500 a 'b'.toml\nx = 1")");
    EXPECT_EQ(result.exit_code, kNoFolder);
    EXPECT_THAT(result.output, Not(HasSubstr("started")));
    EXPECT_TRUE(left_nothing());
}

TEST_F(RemoteScript, ACheckStartsNothing) {
    program("echo started >&2");
    RemoteOrder check = order();
    check.only_check = true;
    const ProgramResult result = run(check, "true");
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_THAT(result.output, HasSubstr("thimble: good"));
    EXPECT_THAT(result.output, Not(HasSubstr("started")));
}

// Quoted text comes back whole from a real shell.
std::string echoed(const std::string& words) {
    return run_program("sh", {"-c", "printf '%s|' " + words}, "/", "install a shell").output;
}

TEST(ShellWords, WhatAShellWouldTouchComesBackUntouched) {
    const std::vector<std::string> words{"",   "it's", "a b",     "$HOME",    "`id`", "\"", "\\", "*",  "~",
                                         "''", "a\nb", "$(exit)", "; exit 1", "!x",   "-n", "#",  "%s", "\t"};
    std::string expected;
    for (const std::string& word : words) expected += word + "|";
    EXPECT_EQ(echoed(shell_words(words)), expected);
}

RC_GTEST_PROP(ShellWords, AnyBytesButNulComeBack, ()) {
    auto word = *rc::gen::container<std::string>(rc::gen::inRange<char>(1, 127));
    RC_ASSERT(echoed(shell_word(word)) == word + "|");
}

// The launcher's end, with real shells: what goes to a file and what does not.
namespace fs = std::filesystem;

class Diverted : public testing::Test {
  protected:
    // The whole output, and its part that went to `file`.
    std::string run(const std::string& script, const fs::path& file) {
        RemoteShell shell({"sh", "-c", script}, folder_ / "log");
        shell.divert_after("turn:", [&](const auto& numbers) {
            return RemoteShell::Files{{file, numbers.front()}, {folder_ / "second", numbers.back()}};
        });
        while (!shell.poll()) wall_sleep(std::chrono::milliseconds{1});
        numbers_ = shell.diverted();
        in_file_ = shell.in_file();
        fault_ = shell.fault();
        return shell.said();
    }
    std::string kept() const { return read_text(folder_ / "kept"); }

    const TemporaryDirectory folder_;
    std::optional<RemoteShell::Numbers> numbers_;
    std::string fault_;
    std::uint64_t in_file_ = 0;
};

TEST_F(Diverted, WhatFollowsTheWordGoesToTheFiles) {
    EXPECT_EQ(run("echo a turn: no; echo turn: 3 10; echo turn: 5; printf '\\000x'", folder_ / "kept"),
              "a turn: no\n");
    EXPECT_EQ(numbers_, (RemoteShell::Numbers{3, 10}));
    EXPECT_EQ(kept() + "|" + read_text(folder_ / "second"), std::string("tur|n: 5\n\0x", 11));
    EXPECT_EQ(in_file_, 10U);
}

TEST_F(Diverted, AWordInTwoPiecesIsFoundAndALongFileIsWhole) {
    EXPECT_EQ(run("printf 'a\\ntur'; sleep 0.02; echo n: 300000; head -c 300000 /dev/zero", folder_ / "kept"),
              "a\n");
    EXPECT_EQ(fs::file_size(folder_ / "kept"), 300000U);
}

TEST_F(Diverted, NothingMakesNoFile) {
    EXPECT_EQ(run("echo turn: 0", folder_ / "kept"), "");
    EXPECT_FALSE(fs::exists(folder_ / "kept"));
    EXPECT_EQ(run("echo all", folder_ / "kept"), "all\n");
    EXPECT_EQ(numbers_, std::nullopt);
}

TEST_F(Diverted, WhatCannotBeWrittenIsMissing) {
    run("echo turn: 5; echo many", folder_ / "no/such");
    EXPECT_EQ(in_file_, 0U);
}

// None of these ends by itself: the launcher ends it, and says which limit it did not keep.
TEST_F(Diverted, AShellThatSaysTooMuchIsCutOff) {
    run("yes turn", folder_ / "kept");
    EXPECT_THAT(fault_, HasSubstr("sends more than 1048576 bytes"));
    run("echo turn: 10; yes", folder_ / "kept");
    EXPECT_THAT(fault_, HasSubstr("sends more than the 10 bytes that it announced"));
    EXPECT_EQ(fs::file_size(folder_ / "kept"), 10U);
    run("echo turn: 1000000000000000000; yes", folder_ / "none");
    EXPECT_THAT(fault_, HasSubstr("announces 1000000000000000000 bytes"));
    EXPECT_FALSE(fs::exists(folder_ / "none"));
}

// Each of them has room: together they have not. A shell that ends gives back the room of the bytes that it did not send.
TEST_F(Diverted, TheFilesOfAllShellsShareHalfOfTheRoom) {
    const std::uint64_t third = fs::space(folder_ / "").available / 3;
    const std::vector<std::string> command{"sh", "-c", fmt::format("echo turn: {}; exec cat", third)};
    const auto fault_of = [](RemoteShell& shell, const fs::path& file) {
        shell.divert_after("turn:", [&](const auto& numbers) {
            return RemoteShell::Files{{file, numbers.back()}};
        });
        while (!shell.diverted() && !shell.poll()) wall_sleep(std::chrono::milliseconds{1});
        return shell.fault();
    };
    {
        RemoteShell first(command, folder_ / "log"), second(command, folder_ / "log");
        EXPECT_EQ(fault_of(first, folder_ / "a"), "");
        EXPECT_THAT(fault_of(second, folder_ / "b"), HasSubstr("more than half of the free space"));
    }
    RemoteShell third_shell(command, folder_ / "log");
    EXPECT_EQ(fault_of(third_shell, folder_ / "c"), "");
}

TEST_F(Diverted, AGoodbyeBehindTheFileIsNoFault) {
    run("echo turn: 2; printf ab; echo goodbye", folder_ / "kept");
    EXPECT_EQ(kept(), "ab");
    EXPECT_EQ(fault_, "");
}

TEST_F(Diverted, TheLogOfItsWordsHasALimit) {
    RemoteShell shell({"sh", "-c", "head -c 10000000 /dev/zero | tr '\\0' x >&2; printf '\\33[2Jend' >&2"},
                      folder_ / "log");
    while (!shell.poll()) wall_sleep(std::chrono::milliseconds{1});
    EXPECT_LT(fs::file_size(folder_ / "log"), 5'000'000U);
    EXPECT_THAT(shell.last_lines(), HasSubstr("more than 4194304 bytes: dropped"));
    EXPECT_LT(shell.last_lines().size(), 2000U);
}

TEST_F(Diverted, NoCommandReachesATerminal) {
    RemoteShell shell({"sh", "-c", "printf '\\33[2Jred\\n' >&2"}, folder_ / "words");
    while (!shell.poll()) wall_sleep(std::chrono::milliseconds{1});
    EXPECT_EQ(shell.last_lines(), "?[2Jred");
}

}  // namespace
}  // namespace thimble
