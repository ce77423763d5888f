// Maps as users start them: the same table from threads and from ranks, and what a killed one leaves.
#include <algorithm>
#include <csignal>
#include <fstream>
#include <iterator>
#include <string>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/loopback/programs.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;

const std::filesystem::path kMpirun = "/usr/bin/mpirun";

#define SKIP_WITHOUT_MPI()                                                              \
    if (!std::filesystem::exists(built_programs() / "../lib/thimble/thimble-ranks.so")) \
        GTEST_SKIP() << "built without THIMBLE_MPI";                                    \
    if (!std::filesystem::exists(kMpirun)) GTEST_SKIP() << kMpirun << " is missing: package openmpi-bin"

std::vector<std::string> map_words(const std::filesystem::path& out, const std::vector<std::string>& more) {
    return words_in(
        "--hand B --compensators none,wave --jitter-s 0,0.003 --delay-s 0:0.1:3 --gain 0.02:2:4 --out " +
            out.string(),
        more);
}

// One machine's ranks, also where there are fewer cores, as root in a container, without a network.
std::vector<std::string> with_ranks(int ranks, std::vector<std::string> words) {
    words.insert(words.begin(), (built_programs() / "thimble").string());
    return words_in(
        "--allow-run-as-root --oversubscribe --bind-to none --mca btl self,vader,tcp "
        "--mca btl_vader_single_copy_mechanism none -n " +
            std::to_string(ranks),
        words);
}

Outcome run_ranks(int ranks, const std::vector<std::string>& words) {
    return run_to_end(kMpirun, with_ranks(ranks, words));
}

std::vector<std::string> sweep(const std::vector<std::string>& words) { return words_in("sweep", words); }

TEST(SweepProgram, RanksAndThreadsMakeTheSameTable) {
    SKIP_WITHOUT_MPI();
    const Folder folder;
    const Outcome threads = run_thimble(sweep(map_words(folder / "threads", {"--jobs", "2"})));
    ASSERT_EQ(threads.code, 0) << threads.words;
    const std::string table = read_text(folder / "threads/map.csv");
    EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 1 + 2 * 2 * 3 * 4);
    for (const int ranks : {1, 2, 3}) {
        const auto out = folder / std::to_string(ranks);
        const Outcome outcome = run_ranks(ranks, sweep(map_words(out, {"--block", std::to_string(ranks)})));
        ASSERT_EQ(outcome.code, 0) << outcome.words;
        EXPECT_EQ(read_text(out / "map.csv"), table) << ranks;
    }
}

std::size_t lines_in(const std::filesystem::path& file) {
    const std::string text = std::filesystem::exists(file) ? read_text(file) : "";
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

std::vector<pid_t> children_of(pid_t parent) {
    std::ifstream file(fmt::format("/proc/{0}/task/{0}/children", parent));
    return {std::istream_iterator<pid_t>(file), {}};
}

// mpirun ends all when one goes; --resume, with another number of them, goes on.
TEST(SweepProgram, ADeadRankLeavesWhatWasDone) {
    SKIP_WITHOUT_MPI();
    const Folder folder;
    const auto out = folder / "map", whole = folder / "whole";
    const auto words = [](const std::filesystem::path& where) {
        return words_in("--delay-s 0:0.2:12 --contact-stiffness-N-per-m 100:20000:60 --block 3 --out " +
                        where.string());
    };
    {
        Child mpirun(kMpirun, with_ranks(2, sweep(words(out))), folder / "mpirun.log");
        ASSERT_TRUE(wait_until([&] { return lines_in(out / "map.csv") > 30; })) << mpirun.last_lines();
        if (!std::filesystem::exists(fmt::format("/proc/self/task/{}/children", getpid())))
            GTEST_SKIP() << "this kernel does not say who mpirun's children are: CONFIG_PROC_CHILDREN";
        const std::vector<pid_t> ranks = children_of(mpirun.pid());
        if (ranks.size() == 2) kill(ranks.back(), SIGKILL);
        const auto code = mpirun.wait(kPatience);
        ASSERT_TRUE(code);
        // Unless all was done before.
        EXPECT_TRUE(*code != 0 || lines_in(out / "map.csv") == 1 + 12 * 60) << *code;
    }
    std::vector<std::string> resume = words(out);
    resume.emplace_back("--resume");
    const Outcome on = run_ranks(3, sweep(resume));
    ASSERT_EQ(on.code, 0) << on.words;
    ASSERT_EQ(run_thimble(sweep(words(whole))).code, 0);
    EXPECT_EQ(read_text(out / "map.csv"), whole_text(whole / "map.csv"));
}

// Once, by the first rank, and no rank is left waiting.
TEST(SweepProgram, AMistakeUnderMpirunIsSaidOnce) {
    SKIP_WITHOUT_MPI();
    const Outcome outcome = run_ranks(2, {"sweep", "--hand", "Z", "--out", "/nowhere"});
    EXPECT_EQ(outcome.code, 2);
    const std::string words = "--hand Z: choose from A, B, C, D and E";
    ASSERT_THAT(outcome.words, HasSubstr(words));
    EXPECT_EQ(outcome.words.find(words), outcome.words.rfind(words));
}

// Two ranks, each with its own words, as on two machines that share nothing.
Outcome on_two_machines(const std::vector<std::string>& first, const std::vector<std::string>& second) {
    std::vector<std::string> words = with_ranks(1, first);
    words.insert(words.end(), {":", "-n", "1", (built_programs() / "thimble").string()});
    words.insert(words.end(), second.begin(), second.end());
    return run_to_end(kMpirun, words);
}

// Two machines with another file of the same name would mix two sessions in one table.
TEST(SweepProgram, ARankWithAnotherSessionRefuses) {
    SKIP_WITHOUT_MPI();
    const Folder folder;
    folder.write("one.toml", "[master]\nforce_scale = 1\n");
    folder.write("other.toml", "[master]\nforce_scale = 2\n");
    for (const char* command : {"compensators --subjects 1 --only HF --delays-s 0",
                                "study --seeds 2 --subjects 2 --experiment 3"}) {
        const auto words = [&](const std::string& file) {
            return words_in(
                fmt::format("{} {} --out {}", command, (folder / file).string(), (folder / "out").string()));
        };
        const Outcome outcome = on_two_machines(words("one.toml"), words("other.toml"));
        EXPECT_EQ(outcome.code, 2) << command;
        EXPECT_THAT(outcome.words, ContainsRegex("rank 1 on .* has .* items of plan .*, rank 0 has"))
            << command;
    }
}

// Before the ranks have joined, and after. One without the rows that are there would have other items.
TEST(SweepProgram, ARankThatFailsAloneOrLacksRowsEndsTheJobAndIsNamed) {
    SKIP_WITHOUT_MPI();
    const Folder folder;
    const auto full = folder / "full";
    ASSERT_EQ(run_thimble(sweep(map_words(full, {}))).code, 0);
    const Outcome before =
        on_two_machines(sweep(map_words(folder / "map", {})), sweep({"--hand", "Z", "--out", "/nowhere"}));
    EXPECT_EQ(before.code, 2);
    EXPECT_THAT(before.words, ContainsRegex("rank 1 on .*--hand Z: choose from A, B, C, D and E"));
    const Outcome after = on_two_machines(sweep(map_words(folder / "map", {})), sweep(map_words(full, {})));
    EXPECT_EQ(after.code, 1);
    EXPECT_THAT(after.words, ContainsRegex("rank 1 on .*holds a map already"));
    const std::string table = read_text(full / "map.csv");
    std::ofstream(full / "map.csv") << table.substr(0, table.find('\n', table.size() / 2) + 1);
    const std::vector<std::string> resume{"--resume", "--block", "1"};
    const Outcome lacking =
        on_two_machines(sweep(map_words(full, resume)), sweep(map_words(folder / "empty", resume)));
    EXPECT_EQ(lacking.code, 2);
    EXPECT_THAT(lacking.words, ContainsRegex("rank 1 on .* has 48 items of plan .*, rank 0 has 2. items"));
}

TEST(SweepProgram, WithoutItsModuleForRanksThimbleSaysSo) {
    const Folder folder;
    std::filesystem::copy(built_programs() / "thimble", folder / "thimble");
    const Outcome outcome =
        run_to_end("/usr/bin/env", {"OMPI_COMM_WORLD_SIZE=2", (folder / "thimble").string(), "sweep"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.words, HasSubstr("build with -DTHIMBLE_MPI=ON"));
}

// Studies over seeds and the board go through the same pool.
TEST(SweepProgram, RanksAndThreadsMakeTheSameTrialsAndRows) {
    SKIP_WITHOUT_MPI();
    const Folder folder;
    const auto both = [&folder](const std::string& words, const std::string& file) {
        const auto threads = folder / "threads", ranks = folder / "ranks";
        const Outcome one = run_thimble(words_in(words + " --overwrite --jobs 3 --out " + threads.string()));
        const Outcome two = run_ranks(2, words_in(words + " --overwrite --out " + ranks.string()));
        ASSERT_EQ(one.code, 0) << one.words;
        EXPECT_EQ(two.code, 0) << two.words;
        EXPECT_GT(lines_in(threads / file), 2U) << words;
        EXPECT_EQ(read_text(ranks / file), read_text(threads / file)) << words;
    };
    both("study --seeds 2 --subjects 2 --experiment 3", "claims_seeds.csv");
    both("board --quick --only CF,scaled,0ms,50ms", "board.csv");
}

// A map of too many panels has no figure, so none of an earlier map may stay.
TEST(SweepProgram, AMapThatBeginsAnewLosesTheEarlierFigure) {
    const Folder folder;
    for (const char* name : {"map.svg", "map.pdf", "map.tsv", "map.gp"}) folder.write(name, "earlier\n");
    const Outcome outcome =
        run_thimble(words_in("sweep --hand A,B,C,D,E --jitter-s 0:0.007:8 --delay-s 0 --gain 0.01 --out " +
                             (folder / "").string()));
    EXPECT_EQ(outcome.code, 0) << outcome.words;
    EXPECT_THAT(outcome.words, HasSubstr("no figure: the map has 40 panels"));
    for (const char* name : {"map.svg", "map.pdf", "map.tsv", "map.gp"})
        EXPECT_FALSE(std::filesystem::exists(folder / name)) << name;
}

TEST(SweepProgram, RefusesWhatItsOperatorDoesNotUse) {
    const Folder folder;
    for (const char* words : {"--operator virtual --step-s 0.01", "--operator virtual --press-N 9",
                              "--operator virtual --friction-N 0", "--trials 2"}) {
        const Outcome outcome =
            run_thimble(words_in(std::string("sweep ") + words, {"--out", (folder / "map").string()}));
        EXPECT_EQ(outcome.code, 2) << words;
        EXPECT_THAT(outcome.words, HasSubstr("is not used by --operator")) << words;
    }
}

TEST(SweepProgram, TheVirtualOperatorsCells) {
    const Folder folder;
    const Outcome outcome =
        run_thimble({"sweep", "--operator", "virtual", "--compensators", "none,CF", "--delay-s", "0.05",
                     "--gain", "1", "--loss", "0.01", "--out", (folder / "map").string()});
    ASSERT_EQ(outcome.code, 0) << outcome.words;
    const std::string table = read_text(folder / "map/map.csv");
    EXPECT_THAT(table, HasSubstr("\nvirtual,virtual,none,0,0.01,0.05,1,9000,"));
    EXPECT_THAT(table, ContainsRegex(",none,[^\n]*,O,"));
    EXPECT_THAT(table, ContainsRegex(",CF,[^\n]*,S,"));
}

}  // namespace
}  // namespace thimble
