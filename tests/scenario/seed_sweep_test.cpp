// The whole study with one seed after another.
#include "study/sweeps/seed_sweep.hpp"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "study/study.hpp"
#include "tests/scenario/trials.hpp"

namespace thimble::test {
namespace {

TEST(SeedSweep, CountsWhatEachSeedJudges) {
    const auto folder = std::filesystem::path(testing::TempDir()) / "thimble_seed_sweep";
    std::filesystem::remove_all(folder);
    SweepOptions options;
    options.protocols = {experiment_3(paper(), 3, 5)};
    options.protocols[0].trials_per_modality = 1;
    options.seeds = 2;
    options.out = folder;
    const TallyResult result = run_sweep(paper(), options);
    EXPECT_TRUE(result.complete);
    EXPECT_EQ(result.tally.studies(), 2U);

    std::uint32_t stable = 0;
    for (const std::uint64_t seed : {5U, 6U}) {
        StudyOptions study;
        study.protocols = options.protocols;
        study.protocols[0].seed = seed;
        study.control = false;
        study.out = folder / std::to_string(seed);
        for (const Claim& c : run_study(paper(), study).claims) {
            if (c.id == "E3.stable" && c.reproduced.value_or(false)) ++stable;
        }
    }
    bool found = false;
    for (const ClaimCount& c : result.tally.counts()) {
        if (c.claim.id == "E1.mean.order") {
            EXPECT_EQ(c.judged, 0U);
        }
        if (c.claim.id != "E3.stable") continue;
        found = true;
        EXPECT_EQ(c.judged, 2U);
        EXPECT_EQ(c.reproduced, stable);
        EXPECT_LE(c.interval().low, c.fraction());
        EXPECT_GE(c.interval().high, c.fraction());
    }
    EXPECT_TRUE(found);
    std::ifstream table(folder / "claims_seeds.csv");
    std::size_t lines = 0;
    for (std::string line; std::getline(table, line);) ++lines;
    EXPECT_EQ(lines, 1 + 2 * result.tally.counts().size());
    EXPECT_TRUE(std::filesystem::exists(folder / "claims.json"));
    EXPECT_TRUE(std::filesystem::exists(folder / "report.html"));
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace thimble::test
