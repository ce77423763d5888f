// thimble board as users start it: the same table with any number of threads, interrupted or not, and a page that leads to a trial.
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "study/board/board_row.hpp"
#include "tests/loopback/programs.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

Outcome board(const std::string& words, const std::filesystem::path& out) {
    return run_thimble(
        words_in("board --quick --only HF,CF,every-sample,0ms,50ms " + words + " --out " + out.string()));
}

TEST(BoardProgram, TheSameBytesWithAnyNumberOfThreadsAndAfterAnInterruption) {
    const Folder folder;
    const auto one = folder / "one", three = folder / "three", resumed = folder / "resumed";
    const Outcome outcome = board("--jobs 1", one);
    ASSERT_EQ(outcome.code, 0) << outcome.words;
    const std::string own = "three/sessions/own.toml";  // a user's
    std::filesystem::create_directories(three / "sessions");
    folder.write(own, "[session]\n");
    ASSERT_EQ(board("--jobs 3", three).code, 0);
    EXPECT_EQ(read_text(folder / own), "[session]\n");
    const std::string table = read_text(one / "board.csv");
    EXPECT_EQ(read_text(three / "board.csv"), table);
    std::filesystem::create_directory(resumed);
    const std::size_t first_row = table.find('\n', table.find('\n') + 1);
    std::ofstream(resumed / "board.csv") << table.substr(0, first_row + 20);  // and a piece of the next one
    std::ofstream(resumed / "board.txt") << read_text(one / "board.txt");
    const Outcome on = board("--resume", resumed);
    EXPECT_EQ(on.code, 0) << on.words;
    EXPECT_THAT(on.words, HasSubstr("1 of 4 rows were already done"));
    EXPECT_EQ(read_text(resumed / "board.csv"), table);
    EXPECT_EQ(board("--resume --seed 2", resumed).code, 2);
    // HF at 50 ms fails; its session is there to look at.
    EXPECT_THAT(read_text(one / "board.html"), HasSubstr("thimble run sessions/HF_every-sample_50ms.toml"));
    const Outcome seen = run_thimble({"run", (one / "sessions/HF_every-sample_50ms.toml").string(), "--clock",
                                      "virtual", "--out", (folder / "seen").string()});
    EXPECT_EQ(seen.code, 0) << seen.words;
    EXPECT_THAT(seen.words, HasSubstr("oscillates"));
}

TEST(BoardProgram, APluginIsARowAndABadOneCostsItsOwnRowOnly) {
    const Folder folder;
    const std::string words = "board --quick --only mine,bad_abi,wave,deadband,50ms --plugin " THIMBLE_PLUGINS
                              "/mine.so --plugin " THIMBLE_PLUGINS "/bad_abi.so --out ";
    const Outcome outcome = run_thimble(words_in(words + (folder / "own").string()));
    EXPECT_EQ(outcome.code, 1);
    EXPECT_THAT(outcome.words, HasSubstr("bad_abi, deadband, 50ms: "));
    const std::vector<BoardRow> rows = read_board_rows(folder / "own/board.csv");
    ASSERT_EQ(rows.size(), 3U);
    EXPECT_THAT(rows[0].status, StartsWith("not possible: "));  // wave variables go without a codec
    EXPECT_EQ(rows[1].status, "ok");
    EXPECT_EQ(rows[1].trials, 5U);
    EXPECT_GT(rows[1].values[kPenetrationMax].mean, 0);
    EXPECT_THAT(rows[2].status, HasSubstr("99"));
    run_thimble(words_in("board --quick --only bad_abi,deadband,50ms --plugin " THIMBLE_PLUGINS
                         "/bad_abi.so --out " +
                         (folder / "bad").string()));
    EXPECT_THAT(read_text(folder / "bad/board.html"), HasSubstr("Not dominated (front 1): none."));
}

TEST(BoardProgram, ChecksAPlugin) {
    const Outcome good = run_thimble({"board", "--check", THIMBLE_PLUGINS "/mine.so", "--json"});
    EXPECT_EQ(good.code, 0) << good.words;
    EXPECT_THAT(good.words, HasSubstr("\"findings\""));
    EXPECT_EQ(run_thimble({"board", "--check", THIMBLE_PLUGINS "/no_symbol.so"}).code, 1);
}

TEST(BoardProgram, MistakesAreSaidBeforeTheFirstTrial) {
    const Folder folder;
    const Outcome unknown = run_thimble(words_in("board --only waves --out " + (folder / "a").string()));
    EXPECT_EQ(unknown.code, 2);
    EXPECT_THAT(unknown.words, HasSubstr("--only waves"));
    const Outcome absent = board("--plugin /nowhere/mine.so", folder / "b");
    EXPECT_EQ(absent.code, 2);
    EXPECT_THAT(absent.words, HasSubstr("/nowhere/mine.so"));
}

}  // namespace
}  // namespace thimble
