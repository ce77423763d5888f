// `thimble replay` as users start it: files in, files out, exit codes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/loopback/programs.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

Outcome replay(const std::vector<std::string>& arguments) {
    return run_thimble(words_in("replay", arguments));
}

TEST(ReplayProgram, ANeedleThroughTheDefaultScene) {
    const Folder folder;
    const auto needle = folder.write("needle.csv", "time_s,position_needle_m\n0,0\n1,0.05\n3,0.13\n4,0\n");
    const Outcome outcome = replay({"--needle", needle.string(), "--out", (folder / "forces.csv").string()});
    EXPECT_EQ(outcome.code, 0) << outcome.words;
    EXPECT_THAT(outcome.words, HasSubstr("4 samples over 4 s"));
    EXPECT_THAT(read_text(folder / "forces.csv"), StartsWith("time_s,position_needle_m,position_tissue_m,"));
    const std::string events = read_text(folder / "forces.events.csv");
    EXPECT_THAT(events, StartsWith("time_s,element,phase\n"));
    EXPECT_THAT(events, HasSubstr(",tissue,penetrated\n"));
    EXPECT_THAT(events, HasSubstr(",fixture,touched\n"));
}

TEST(ReplayProgram, MistakesHaveTheirExitCodes) {
    const Folder folder;
    const auto good = folder.write("good.csv", "time_s,position_needle_m\n0,0\n1,0.01\n");
    const auto bad = folder.write("bad.csv", "time_s,position_needle_m\n0,0\n0,0.01\n");
    const auto scene = folder.write("scene.toml", "[tissue]\nmas_kg = 1\n");
    const std::string out = (folder / "out.csv").string();
    const Outcome data = replay({"--needle", bad.string(), "--out", out});
    EXPECT_EQ(data.code, 5);
    EXPECT_THAT(data.words, HasSubstr("bad.csv:3:"));
    const Outcome usage = replay({"--scene", scene.string(), "--needle", good.string(), "--out", out});
    EXPECT_EQ(usage.code, 2);
    EXPECT_THAT(usage.words, HasSubstr("scene.toml:2:"));
    EXPECT_EQ(replay({"--needle", good.string(), "--out", out, "--solver", "euler"}).code, 2);
    EXPECT_EQ(replay({"--out", out}).code, 2);
    EXPECT_EQ(replay({"--needle", good.string(), "--out", (good / "out.csv").string()}).code,
              2);  // no folder
    EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace thimble
