// Studies over seeds, along a parameter, and over joint draws of several, small enough to run in a moment.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/csv/csv_file.hpp"
#include "common/error.hpp"
#include "session/virtual/virtual_session.hpp"
#include "study/ordered_workers.hpp"
#include "study/study.hpp"
#include "study/sweeps/seed_sweep.hpp"
#include "study/sweeps/variation.hpp"
#include "tests/scenario/trials.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble::test {
namespace {

class Sweeps : public testing::Test {
  protected:
    Sweeps() {
        options_.protocols = {experiment_3(paper(), 3, 5)};
        options_.protocols[0].trials_per_modality = 1;
        options_.out = folder_;
    }

    std::string text(const char* name) const { return read_text(folder_ / name); }
    std::size_t lines(const char* name) const {
        const std::string all = text(name);
        return static_cast<std::size_t>(std::count(all.begin(), all.end(), '\n'));
    }

    TemporaryDirectory temporary_;
    std::filesystem::path folder_ = temporary_ / "out";
    SweepOptions options_;
};

TEST_F(Sweeps, CountsWhatEachSeedJudges) {
    options_.seeds = 2;
    const TallyResult result = run_sweep(paper(), options_);
    EXPECT_TRUE(result.complete);
    EXPECT_EQ(result.tally.studies(), 2U);

    std::uint32_t stable = 0;
    for (const std::uint64_t seed : {5U, 6U}) {
        StudyOptions study;
        study.protocols = options_.protocols;
        study.protocols[0].seed = seed;
        study.control = false;
        study.out = folder_ / std::to_string(seed);
        for (const Claim& c : run_study(paper(), study).claims) {
            if (c.id == "E3.stable" && c.reproduced.value_or(false)) ++stable;
        }
    }
    bool found = false;
    for (const ClaimCount& c : result.tally.counts()) {
        if (c.claim.id == "E1.mean.order") {
            EXPECT_EQ(c.judged, 0U);
        }
        // Three subjects are too few for a test, which is no failure to reproduce.
        EXPECT_EQ(c.classified() == ClaimClass::kNotJudged, c.claim.id != "E3.stable") << c.claim.id;
        if (c.claim.id != "E3.stable") continue;
        found = true;
        EXPECT_EQ(c.judged, 2U);
        EXPECT_EQ(c.reproduced, stable);
        EXPECT_LE(c.interval().low, c.fraction());
        EXPECT_GE(c.interval().high, c.fraction());
    }
    EXPECT_TRUE(found);
    EXPECT_EQ(lines("claims_seeds.csv"), 1 + 2 * result.tally.counts().size());
    EXPECT_TRUE(std::filesystem::exists(folder_ / "claims.json"));
    EXPECT_TRUE(std::filesystem::exists(folder_ / "report.html"));
}

double stable_fraction(const VariedPoint& point) {
    for (const ClaimCount& c : point.tally.counts()) {
        if (c.claim.id == "E3.stable") return c.fraction();
    }
    return -1;
}

// With 3 N of friction no first touch is thrown out, with 0.4 N every one is.
TEST_F(Sweeps, AParameterDecidesWhichClaimsSurvive) {
    const VariationResult result =
        run_variations("", {parse_parameter_range("handle.friction_N=0.4:3:2")}, options_);
    EXPECT_TRUE(result.complete);
    ASSERT_EQ(result.variations.size(), 1U);
    ASSERT_EQ(result.variations[0].points.size(), 2U);
    EXPECT_EQ(stable_fraction(result.variations[0].points[0]), 1);
    EXPECT_EQ(stable_fraction(result.variations[0].points[1]), 0);
    EXPECT_EQ(lines("claims_vary.csv"), 1 + 2 * result.variations[0].points[0].tally.counts().size());
    EXPECT_NE(text("report.html").find("handle.friction_N"), std::string::npos);
    EXPECT_NE(text("vary.json").find("E3.stable"), std::string::npos);
}

TEST_F(Sweeps, NothingIsWrittenIfAnyPointIsRefused) {
    const std::vector<ParameterRange> ranges{parse_parameter_range("handle.friction_N=0.4:1:2"),
                                             parse_parameter_range("operator.brake_s=0.1:9:2")};
    EXPECT_THROW(run_variations("", ranges, options_), Error);
    EXPECT_THROW(run_draws("", {parse_parameter_range("operator.brake_s=0.1:9")}, options_), Error);
    EXPECT_FALSE(std::filesystem::exists(folder_));
}

TEST_F(Sweeps, DrawsAreKeptWithWhatCameOut) {
    options_.seeds = 2;
    const std::vector<ParameterRange> ranges{parse_parameter_range("handle.friction_N=0.4:1"),
                                             parse_parameter_range("operator.brake_s=0.1:0.2")};
    const TallyResult result = run_draws("", ranges, options_);
    EXPECT_TRUE(result.complete);
    EXPECT_EQ(result.tally.studies(), 2U);
    EXPECT_EQ(lines("draws.csv"), 3U);
    EXPECT_EQ(text("draws.csv").rfind("seed,handle.friction_N,operator.brake_s\n5,", 0), 0U);
    EXPECT_EQ(lines("claims_draws.csv"), 1 + 2 * result.tally.counts().size());
    EXPECT_TRUE(std::filesystem::exists(folder_ / "claims.json"));
}

TEST_F(Sweeps, AnInterruptKeepsWhatWasDone) {
    std::atomic<bool> stop = false;
    options_.stop = &stop;
    options_.seeds = 1000000;  // would take days
    std::thread user([&] {
        while (lines("claims_draws.csv") < 2) std::this_thread::sleep_for(std::chrono::milliseconds{1});
        stop = true;
    });
    const TallyResult result = run_draws("", {parse_parameter_range("handle.friction_N=0.4:1")}, options_);
    user.join();
    EXPECT_FALSE(result.complete);
    EXPECT_GE(result.tally.studies(), 1U);
    EXPECT_EQ(lines("draws.csv"), 1 + result.tally.studies());
    EXPECT_EQ(lines("claims_draws.csv"), 1 + result.tally.studies() * result.tally.counts().size());
    EXPECT_NE(text("report.html").find("interrupted"), std::string::npos);
}

TEST_F(Sweeps, APointThatWasInterruptedIsNoPoint) {
    const std::atomic<bool> stop = true;
    options_.stop = &stop;
    const VariationResult result =
        run_variations("", {parse_parameter_range("handle.friction_N=0.4:1:2")}, options_);
    EXPECT_FALSE(result.complete);
    EXPECT_TRUE(result.variations.empty());
    EXPECT_EQ(lines("claims_vary.csv"), 1U);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "report.html"));
}

// Its trials beside the claims of others would pass for theirs.
TEST_F(Sweeps, AReplacedStudyLeavesNothingBehind) {
    std::filesystem::create_directories(folder_ / "figures");
    const std::vector<std::string> results{"trials.csv",      "summary.json",    "findings.json",
                                           "subjects.csv",    "figures/bars.gp", "figures/bars.tsv",
                                           "figures/bars.svg"};
    for (const std::string& file : results) std::ofstream(folder_ / file) << "a study's\n";
    claim_folder(options_);  // not asked to replace
    EXPECT_TRUE(std::filesystem::exists(folder_ / "trials.csv"));
    options_.if_exists = IfExists::kReplace;
    {
        const CsvFile written(folder_ / "trials.csv", IfExists::kContinue);
        EXPECT_THROW(claim_folder(options_), Error);
    }
    claim_folder(options_);
    for (const std::string& file : results) EXPECT_FALSE(std::filesystem::exists(folder_ / file)) << file;
}

TEST_F(Sweeps, AnotherReportIsNotReplacedUnasked) {
    std::filesystem::create_directories(folder_);
    std::ofstream(folder_ / "report.html") << "mine";
    EXPECT_THROW(run_draws("", {parse_parameter_range("handle.friction_N=0.4:1")}, options_), Error);
    EXPECT_EQ(text("report.html"), "mine");
}

// The trials of experiment 1 themselves, but for the lag.
TEST(NoLag, OnlyTheLagDiffers) {
    const Protocol one = experiment_1(paper(), 2, 1);
    const std::vector<TrialConditions> again = no_lag_trials({one, experiment_3(paper(), 2, 1)});
    EXPECT_EQ(again.size(), 12U);
    for (const TrialConditions& trial : again) EXPECT_EQ(trial.modality, Modality::kCF);
    const TrialMetrics with = measure(run_virtual_trial(paper(), again[0]));
    const TrialMetrics without = measure(run_virtual_trial(without_lag(paper()), again[0]));
    EXPECT_EQ(with.first_contact_time_s, without.first_contact_time_s);
    EXPECT_GT(with.penetration_max_m, without.penetration_max_m + 0.0002);
    EXPECT_LT(with.penetration_max_m, without.penetration_max_m + 0.002);
}

TEST(RunTrials, NoJobsAreOnePerCore) {
    const auto threads = [](unsigned jobs) {
        using Threads = std::filesystem::directory_iterator;
        std::atomic<bool> stop{false};
        std::ptrdiff_t there = 0;
        run_trials(paper(), all_trials({experiment_3(paper(), 20, 1)}), jobs, &stop, [&](const TrialRecord&) {
            if (stop) return;
            there = std::distance(Threads("/proc/self/task"), Threads());
            stop = true;  // not before: a thread that sees it ends
        });
        return there;
    };
    EXPECT_EQ(threads(0), threads(thread_count(0)));
}

// A trial per modality; files into `folder`.
class StudyFiles : public testing::Test {
  protected:
    void use(std::vector<Protocol> protocols) {
        for (Protocol& protocol : protocols) protocol.trials_per_modality = 1;
        options.protocols = std::move(protocols);
        options.out = folder;
    }
    nlohmann::json json(const char* name) const { return nlohmann::json::parse(read_text(folder / name)); }

    TemporaryDirectory temporary;
    std::filesystem::path folder = temporary / "study";
    StudyOptions options;
};

TEST_F(StudyFiles, AllAnalysesAndFiguresOfAllExperiments) {
    use({experiment_1(paper(), 3, 1), experiment_2(paper(), 4, 1), experiment_3(paper(), 3, 1)});
    run_study(paper(), options);

    for (const char* file : {"trials.csv", "claims.json", "summary.json", "report.html"})
        EXPECT_TRUE(std::filesystem::exists(folder / file)) << file;
    for (const char* of : {"trajectories", "bars", "subjects", "distributions", "differences"}) {
        for (const char* experiment : {"_experiment1", "_experiment2", "_experiment3"}) {
            const std::string name = std::string(of) + experiment;
            EXPECT_FALSE(read_text(folder / "figures" / (name + ".tsv")).empty()) << name;
            EXPECT_FALSE(read_text(folder / "figures" / (name + ".gp")).empty()) << name;
        }
    }
    // Seven measures of six pairs, and who oscillates in three groups of four.
    const auto findings = json("findings.json");
    EXPECT_EQ(findings.size(), 7U * 6 + 3 * 4);
    for (const auto& finding : findings) EXPECT_FALSE(finding["words"].get<std::string>().empty());
    EXPECT_EQ(json("summary.json")["provenance"]["design"],
              "paper-experiment-1, paper-experiment-2, paper-experiment-3");
    const std::string html = read_text(folder / "report.html");
    std::size_t before = 0;
    for (const char* part : {"class=\"answer\"", "<dt>HF</dt>", "Which conditions oscillate",
                             "<h2>The paper's claims", "Provenance"}) {
        EXPECT_GT(html.find(part), before) << part;
        before = html.find(part);
    }
}

// No claim of the paper is about another design.
TEST_F(StudyFiles, AUsersStudyHasFindingsAndNoClaims) {
    use({experiment_3(paper(), 2, 1)});
    options.control = options.paper_design = false;
    EXPECT_TRUE(run_study(paper(), options).claims.empty());
    EXPECT_FALSE(std::filesystem::exists(folder / "claims.json"));
    EXPECT_EQ(json("findings.json").size(), 3U * 6 + 4);
    EXPECT_EQ(json("summary.json")["provenance"]["design"], "user");
    EXPECT_EQ(read_text(folder / "report.html").find("claim"), std::string::npos);
}

TEST_F(StudyFiles, CompensatorsAreComparedByTheSameStatistics) {
    use({experiment_3(paper(), 3, 1)});
    options.control = false;
    options.compensators = {Compensator::kWave, Compensator::kLeastConservative};
    options.trajectories = true;
    ASSERT_TRUE(run_study(paper(), options).complete);
    // The same trial is in three tables, and has a file of each.
    using Files = std::filesystem::directory_iterator;
    EXPECT_EQ(std::distance(Files(folder / "trajectories"), Files()), 12 + 3 + 3);
    const auto plain = read_trial_table(folder / "trials.csv"),
               waves = read_trial_table(folder / "hf_wave.csv");
    ASSERT_EQ(plain.size(), 12U);
    ASSERT_EQ(waves.size(), 3U);
    for (const TrialRow& row : plain) EXPECT_EQ(row.conditions.compensator, Compensator::kNone);
    for (const TrialRow& row : waves) {
        EXPECT_EQ(row.conditions.compensator, Compensator::kWave);
        EXPECT_FALSE(row.metrics.oscillates);
    }
    const auto analysis = json("compensators.json");
    const std::string text = analysis.dump();
    for (const char* name : {"HF+wave", "HF+energy-bound", "CCF"})
        EXPECT_NE(text.find(name), std::string::npos) << name;
    // The paper's claims are about HF as it is.
    EXPECT_EQ(read_text(folder / "claims.json").find("HF+"), std::string::npos);
    // A study with other compensators than these goes on, with its own beside them.
    options.if_exists = IfExists::kContinue;
    options.compensators = {Compensator::kWave};
    EXPECT_EQ(run_study(paper(), options).resumed, 15U);
}

TEST_F(StudyFiles, AStudyGoesOnWithAllOfItsTrajectoriesOrNone) {
    use({experiment_3(paper(), 1, 1)});
    options.control = false;
    options.trajectories = true;
    run_study(paper(), options);
    options.if_exists = IfExists::kContinue;
    EXPECT_EQ(run_study(paper(), options).resumed, 4U);
    options.trajectories = false;
    EXPECT_THROW(run_study(paper(), options), Error);
    std::filesystem::remove_all(folder / "trajectories");
    EXPECT_EQ(run_study(paper(), options).resumed, 4U);
    options.trajectories = true;
    EXPECT_THROW(run_study(paper(), options), Error);
}

// Nothing of the earlier study may pass for the new one's, also if that is interrupted before its first trial.
TEST_F(StudyFiles, AReplacedStudyLeavesNothingBehind) {
    use({experiment_3(paper(), 1, 1)});
    options.protocols[0].trials_per_modality = 1;
    options.trajectories = true;
    run_study(paper(), options);
    const std::atomic<bool> stop = true;
    options.stop = &stop;
    options.if_exists = IfExists::kReplace;
    {
        const CsvFile written(folder / "trials.csv", IfExists::kContinue);
        EXPECT_THROW(run_study(paper(), options), Error);
        EXPECT_TRUE(std::filesystem::exists(folder / "report.html")) << "of a study that still runs";
    }
    EXPECT_FALSE(run_study(paper(), options).complete);
    for (const char* file : {"report.html", "summary.json", "control.csv"})
        EXPECT_FALSE(std::filesystem::exists(folder / file)) << file;
    EXPECT_TRUE(std::filesystem::is_empty(folder / "trajectories"));
    EXPECT_TRUE(std::filesystem::is_empty(folder / "figures"));
}

// One subject is no sample: every comparison says how many are needed, and the study is whole.
TEST_F(StudyFiles, TooFewSubjectsForAnyTest) {
    use({experiment_3(paper(), 1, 1)});
    options.control = false;
    EXPECT_TRUE(run_study(paper(), options).complete);
    for (const auto& finding : json("findings.json")) {
        EXPECT_TRUE(finding["P"].is_null());
        if (finding["comparison"].get<std::string>().find("oscillates") != std::string::npos) continue;
        EXPECT_NE(finding["words"].get<std::string>().find("at least 8 subjects"), std::string::npos);
    }
    for (const auto& claim : json("claims.json"))
        EXPECT_EQ(claim["reproduced"].is_null(), claim["id"] != "E3.stable") << claim["id"];
    EXPECT_TRUE(std::filesystem::exists(folder / "report.html"));
    EXPECT_FALSE(std::filesystem::exists(folder / "figures" / "differences.gp"));
}

}  // namespace
}  // namespace thimble::test
