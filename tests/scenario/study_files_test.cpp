// The files of a study of all experiments.
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "study/study.hpp"
#include "tests/scenario/trials.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble::test {
namespace {

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

    for (const char* file : {"trials.csv", "claims.json", "summary.json", "report.html"}) {
        EXPECT_TRUE(std::filesystem::exists(folder / file)) << file;
    }
    for (const char* of : {"trajectories", "bars", "subjects", "distributions", "differences"}) {
        for (const char* experiment : {"_experiment1", "_experiment2", "_experiment3"}) {
            const std::string name = std::string(of) + experiment;
            EXPECT_FALSE(read_text(folder / "figures" / (name + ".tsv")).empty()) << name;
            EXPECT_FALSE(read_text(folder / "figures" / (name + ".gp")).empty()) << name;
        }
    }
    const auto analysis = json("analysis.json");
    EXPECT_EQ(analysis["analysis"], "full");
    ASSERT_EQ(analysis["measures"].size(), 7U);
    const std::string html = read_text(folder / "report.html");
    for (const auto& measure : analysis["measures"]) {
        EXPECT_TRUE(measure["p"].is_number()) << measure.dump();
        const std::string finding = measure["finding"].get<std::string>();
        // To the first sign that HTML writes otherwise.
        EXPECT_NE(html.find(finding.substr(0, finding.find_first_of("&<>\""))), std::string::npos) << finding;
    }
    // Side by side before the claims, the claims before the experiments.
    EXPECT_LT(html.find("The experiments side by side"), html.find("The paper's claims"));
}

TEST_F(StudyFiles, CompensatorsAreComparedByTheSameStatistics) {
    use({experiment_3(paper(), 3, 1)});
    options.control = false;
    options.compensators = {Compensator::kWave, Compensator::kLeastConservative};
    ASSERT_TRUE(run_study(paper(), options).complete);
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
    EXPECT_EQ(read_text(folder / "analysis.json").find("HF+"), std::string::npos);
    // A study with other compensators than these goes on, with its own beside them.
    options.if_exists = IfExists::kContinue;
    options.compensators = {Compensator::kWave};
    EXPECT_EQ(run_study(paper(), options).resumed, 15U);
}

// One subject is no sample: every test says why, and the study is whole.
TEST_F(StudyFiles, TooFewSubjectsForAnyTest) {
    use({experiment_3(paper(), 1, 1)});
    options.control = false;
    options.analysis = AnalysisKind::kPaper;
    EXPECT_TRUE(run_study(paper(), options).complete);
    const auto analysis = json("analysis.json");
    EXPECT_EQ(analysis["analysis"], "paper");
    ASSERT_EQ(analysis["measures"].size(), 3U);
    for (const auto& measure : analysis["measures"]) {
        EXPECT_TRUE(measure["p"].is_null());
        EXPECT_FALSE(measure["problems"].empty());
        EXPECT_NE(measure["finding"].get<std::string>().find("could not be tested"), std::string::npos);
    }
    EXPECT_TRUE(std::filesystem::exists(folder / "report.html"));
    EXPECT_FALSE(std::filesystem::exists(folder / "figures" / "differences.gp"));
}

}  // namespace
}  // namespace thimble::test
