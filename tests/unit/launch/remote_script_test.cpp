// The script, in a real shell, with programs that are shell scripts themselves. tests/loopback/up_test.cpp has its effect on real nodes.
#include "session/launch/remote_script.hpp"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/process/child.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

class RemoteScript : public testing::Test {
  protected:
    RemoteScript() {
        std::string pattern = (fs::temp_directory_path() / "thimble-script-XXXXXX").string();
        folder_ = mkdtemp(pattern.data());
        fs::create_directories(folder_ / "tmp");
    }
    ~RemoteScript() override { fs::remove_all(folder_); }

    void program(const std::string& script) const {
        std::ofstream(folder_ / "node") << "#!/bin/sh\n[ \"$1\" != --version ] || { echo 1.2.3; exit; }\n"
                                        << script;
        fs::permissions(folder_ / "node", fs::perms::owner_all);
    }
    RemoteOrder order() const {
        RemoteOrder order;
        order.program = "node";
        order.folder = folder_;
        order.version = "1.2.3";
        order.machine = "it's lab 2";
        order.session = "a 'b'.toml";
        order.lease = std::chrono::milliseconds{500};
        return order;
    }
    // The script comes first; `then` is what a launcher would send after kSend, in shell words.
    ProgramResult run(const RemoteOrder& order, const std::string& then) const {
        std::ofstream(folder_ / "script") << remote_script(order);
        return run_program(
            "sh",
            {"-c", "{ cat script; sleep 0.2; " + then + "; } | TMPDIR=" + (folder_ / "tmp").string() + " sh"},
            folder_, "install a shell");
    }
    bool left_nothing() const { return fs::is_empty(folder_ / "tmp"); }

    fs::path folder_;
};

constexpr const char* kSession = R"(printf "5 a 'b'.toml\nx = 1end\n"; sleep 0.4)";

TEST_F(RemoteScript, StartsTheProgramWithWhatWasSent) {
    program(R"(cat "$2"; echo " with $6" >&2; echo '{"good": true}' > "$4"; exit 4)");
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
    program(R"([ "$6" = --log ] && printf 'log of %s' "$8" > "$7"; echo '{}' > "$4"; exit 3)");
    RemoteOrder with = order();
    with.arguments = {"it"};
    EXPECT_THAT(run(with, kSession).output, HasSubstr("thimble: ended 3 0\n"));
    with.messages = true;
    const ProgramResult result = run(with, kSession);
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_THAT(result.output, HasSubstr("thimble: report\n{}\n\nthimble: ended 3 9\nlog of it"));
    EXPECT_TRUE(left_nothing());
}

TEST_F(RemoteScript, EndsTheProgramWhenItsInputEnds) {
    program("trap 'echo told to end >&2; exit 0' TERM\nwhile :; do sleep 0.05; done");
    EXPECT_THAT(run(order(), kSession).output, HasSubstr("told to end"));
    EXPECT_TRUE(left_nothing());
}

TEST_F(RemoteScript, KillsAProgramThatDoesNotListen) {
    program("trap '' TERM\nwhile :; do sleep 0.05; done");
    EXPECT_EQ(run(order(), kSession).exit_code, 128 + 9);
    EXPECT_TRUE(left_nothing());
}

// The pipe stays open, as with a cable that was pulled: no end of file, but no lines either.
TEST_F(RemoteScript, EndsTheProgramWhenNothingComesForTheLease) {
    program("trap 'echo told to end >&2; exit 0' TERM\nwhile :; do sleep 0.05; done");
    const ProgramResult result = run(order(), "printf \"5 a 'b'.toml\\nx = 1end\\n\"; sleep 2");
    EXPECT_THAT(result.output, HasSubstr("told to end"));
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

}  // namespace
}  // namespace thimble
