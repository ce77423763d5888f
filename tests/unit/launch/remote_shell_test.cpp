// The launcher's end, with real shells: what goes to a file and what does not.
#include "session/launch/remote_shell.hpp"

#include <gtest/gtest.h>

#include "common/runtime/wall_clock.hpp"
#include "tests/read_text.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;

class Diverted : public testing::Test {
  protected:
    // The whole output, and its part that went to `file`.
    std::string run(const std::string& script, const fs::path& file) {
        RemoteShell shell({"sh", "-c", script}, folder_ / "log");
        shell.divert_after("turn:", file);
        while (!shell.poll()) wall_sleep(std::chrono::milliseconds{1});
        numbers_ = shell.diverted().value_or("none");
        in_file_ = shell.in_file();
        return shell.said();
    }
    std::string kept() const { return read_text(folder_ / "kept"); }

    const TemporaryDirectory folder_;
    std::string numbers_;
    std::uint64_t in_file_ = 0;
};

TEST_F(Diverted, WhatFollowsTheWordGoesToTheFile) {
    EXPECT_EQ(run("echo a turn: no; echo turn: 3 4; echo turn: 5; printf '\\000x'", folder_ / "kept"),
              "a turn: no\n");
    EXPECT_EQ(numbers_, " 3 4");
    EXPECT_EQ(kept(), std::string("turn: 5\n\0x", 10));
    EXPECT_EQ(in_file_, 10U);
}

TEST_F(Diverted, AWordInTwoPiecesIsFoundAndALongFileIsWhole) {
    EXPECT_EQ(run("printf 'a\\ntur'; sleep 0.02; echo n: 1; head -c 300000 /dev/zero", folder_ / "kept"),
              "a\n");
    EXPECT_EQ(fs::file_size(folder_ / "kept"), 300000U);
}

TEST_F(Diverted, NothingMakesNoFile) {
    EXPECT_EQ(run("echo turn: 0", folder_ / "kept"), "");
    EXPECT_FALSE(fs::exists(folder_ / "kept"));
    EXPECT_EQ(run("echo all", folder_ / "kept"), "all\n");
    EXPECT_EQ(numbers_, "none");
}

TEST_F(Diverted, WhatCannotBeWrittenIsMissing) {
    run("echo turn: 5; echo many", folder_ / "no/such");
    EXPECT_EQ(in_file_, 0U);
}

}  // namespace
}  // namespace thimble
