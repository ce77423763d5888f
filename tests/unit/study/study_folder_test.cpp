// A study goes on with the files of a killed study, and with no others.
#include "study/study_folder.hpp"

#include <fstream>
#include <sstream>
#include <tuple>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble {
namespace {

class StudyFolder : public testing::Test {
  protected:
    StudyFolder() {
        for (std::uint32_t trial = 1; trial <= 4; ++trial) {
            TrialRecord record = sine_record(0.003, 0.001 * trial, 4);
            record.conditions.trial = trial;
            records_.push_back(record);
            planned_.push_back(record.conditions);
        }
    }

    void run(StudyTables& tables, std::size_t from, std::size_t to) const {
        for (std::size_t i = from; i < to; ++i)
            tables.append(make_row(records_[i]), trial_curve(records_[i]));
    }
    StudyTables open(IfExists if_exists) {
        curves_taken_ = 0;
        return {directory_.path(), "trials", if_exists, planned_, [&](const TrialCurve& curve) {
                    EXPECT_EQ(curve.conditions.trial, planned_[curves_taken_].trial);
                    ++curves_taken_;
                }};
    }
    // A study that was killed after so many trials.
    void write_first(std::size_t trials) {
        StudyTables tables = open(IfExists::kRefuse);
        run(tables, 0, trials);
    }
    StudyTables resume() { return open(IfExists::kContinue); }
    // It is not gone on with, and the table has all its bytes.
    void expect_kept(ExitCode code, const std::string& words, const std::string& table_text) {
        const std::string said = refusal([&] { resume(); }, code);
        EXPECT_NE(said.find(words), std::string::npos) << words << ": " << said;
        EXPECT_EQ(table(), table_text);
    }
    std::string table() const { return read_text(directory_ / "trials.csv"); }
    std::string curves() const { return read_text(directory_ / "trials_curves.csv"); }
    void append_text(const std::string& file, const std::string& text) const {
        std::ofstream(directory_ / file, std::ios::binary | std::ios::app) << text;
    }

    TemporaryDirectory directory_;
    std::vector<TrialRecord> records_;
    std::vector<TrialConditions> planned_;
    std::size_t curves_taken_ = 0;
};

TEST_F(StudyFolder, GoesOnWhereItWasKilledWithTheSameBytes) {
    write_first(4);
    const std::string table_text = table();
    const std::string curve_text = curves();
    for (const std::size_t cut : {std::size_t{0}, std::size_t{1}, table_text.find('\n') + 1,
                                  table_text.find('\n') + 30, table_text.size() - 1, table_text.size()}) {
        std::filesystem::resize_file(directory_ / "trials.csv", cut);
        StudyTables again = resume();
        EXPECT_LT(again.rows().size(), 5U);
        EXPECT_EQ(again.rows().size(), curves_taken_);
        run(again, again.rows().size(), 4);
        EXPECT_EQ(table(), table_text) << cut;
        EXPECT_EQ(curves(), curve_text) << cut;
    }
}

TEST_F(StudyFolder, WhatHasNoCurveIsRunAgain) {
    write_first(3);
    const std::string text = curves();
    std::filesystem::resize_file(directory_ / "trials_curves.csv", text.size() - 5);
    EXPECT_EQ(resume().rows().size(), 2U);
}

TEST_F(StudyFolder, CurvesReadBackToTheLastDigit) {
    StudyTables tables = open(IfExists::kRefuse);
    TrialRecord nowhere = records_[0];
    for (TrajectorySample& sample : nowhere.samples) sample.position_needle_m = 0;
    tables.append(make_row(records_[0]), trial_curve(records_[0]));
    tables.append(make_row(nowhere), trial_curve(nowhere));
    std::vector<TrialCurve> back;
    read_curves(directory_ / "trials_curves.csv", [&](const TrialCurve& curve) { back.push_back(curve); });
    ASSERT_EQ(back.size(), 2U);
    const TrialCurve truth = trial_curve(records_[0]);
    EXPECT_TRUE(back[0].placed && back[0].beeped);
    EXPECT_EQ(back[0].beep, truth.beep);
    EXPECT_FALSE(back[1].placed);
    for (std::size_t i = 0; i < kContactGrid.points; ++i) {
        if (std::isnan(truth.needle_percent[i])) {
            EXPECT_TRUE(std::isnan(back[0].needle_percent[i]));
            continue;
        }
        EXPECT_EQ(back[0].needle_percent[i], truth.needle_percent[i]);
        EXPECT_EQ(back[0].surface_percent[i], truth.surface_percent[i]);
    }
}

TEST_F(StudyFolder, AStudyThatStillRunsKeepsItsRows) {
    StudyTables tables = open(IfExists::kRefuse);
    run(tables, 0, 2);
    append_text("trials.csv", "3,1,");  // it is in the middle of a row
    expect_kept(ExitCode::kUsage, "another program is writing", table());
}

TEST_F(StudyFolder, AnotherStudyIsNotGoneOnWith) {
    write_first(2);
    planned_[1].study_seed = 99;
    expect_kept(ExitCode::kUsage, "trials.csv:3", table());
    planned_.resize(1);
    EXPECT_THROW(resume(), Error);
}

TEST_F(StudyFolder, CurvesOnAnotherAxisAreNoOtherVersions) {
    for (const auto& [grid, other, name] : {std::tuple{kContactGrid, kPercentGrid, "--axis contact"},
                                            std::tuple{kPercentGrid, kContactGrid, "--axis percent"}}) {
        const TemporaryDirectory directory;
        const auto take = [](const TrialCurve&) {};
        {
            StudyTables tables(directory.path(), "trials", IfExists::kRefuse, planned_, take, grid);
            tables.append(make_row(records_[0]), trial_curve(records_[0], grid));
        }
        const std::string said = refusal(
            [&, &axis = other] {
                StudyTables(directory.path(), "trials", IfExists::kContinue, planned_, take, axis);
            },
            ExitCode::kUsage);
        EXPECT_NE(said.find(name), std::string::npos) << said;
        EXPECT_EQ(
            StudyTables(directory.path(), "trials", IfExists::kContinue, planned_, take, grid).rows().size(),
            1U);
    }
}

TEST_F(StudyFolder, AStudyOfAnotherSeedKeepsEveryByteWhateverItsCurvesAre) {
    write_first(3);
    append_text("trials.csv", "3,1,");  // and it was killed while it wrote
    const std::string table_text = table();
    const std::string curve_text = curves();
    for (TrialConditions& conditions : planned_) conditions.study_seed = 99;
    for (const std::size_t left : {curve_text.size(), curve_text.size() - 5, curve_text.find('\n') + 1,
                                   std::size_t{7}, std::size_t{0}}) {
        std::ofstream(directory_ / "trials_curves.csv", std::ios::binary) << curve_text.substr(0, left);
        expect_kept(ExitCode::kUsage, "trials.csv:2", table_text);
        EXPECT_EQ(curves(), curve_text.substr(0, left));
    }
    std::filesystem::remove(directory_ / "trials_curves.csv");
    expect_kept(ExitCode::kUsage, "trials.csv:2", table_text);
}

// As `thimble run` and `thimble play --out` leave it: real trials, perhaps under the same conditions.
TEST_F(StudyFolder, TrialsWithoutCurvesAreRefusedAndKept) {
    write_first(3);
    const std::string table_text = table();
    const std::string header = curves().substr(0, curves().find('\n') + 1);
    for (const std::string& left : {header, header.substr(0, 7), std::string()}) {
        std::ofstream(directory_ / "trials_curves.csv", std::ios::binary) << left;
        expect_kept(ExitCode::kData, "trials_curves.csv", table_text);
    }
    std::filesystem::remove(directory_ / "trials_curves.csv");
    expect_kept(ExitCode::kData, "--out", table_text);
    EXPECT_FALSE(std::filesystem::exists(directory_ / "trials_curves.csv"));
}

TEST_F(StudyFolder, CurvesOfOtherTrialsAreRefusedAndNothingIsCut) {
    {
        StudyTables tables = open(IfExists::kRefuse);
        tables.append(make_row(records_[0]), trial_curve(records_[0]));
        tables.append(make_row(records_[1]), trial_curve(records_[3]));
        tables.append(make_row(records_[2]), trial_curve(records_[2]));
    }
    append_text("trials_curves.csv", "3,1,");
    const std::string curve_text = curves();
    expect_kept(ExitCode::kData, "trials_curves.csv:3", table());
    EXPECT_EQ(curves(), curve_text);
}

TEST_F(StudyFolder, ATableOfAnEarlierVersionIsRefusedAndKept) {
    write_first(2);
    std::string text;
    std::istringstream lines(table());
    for (std::string line; std::getline(lines, line);) text += line.substr(0, line.rfind(',')) + '\n';
    text += "3,1";
    std::ofstream(directory_ / "trials.csv", std::ios::binary) << text;
    expect_kept(ExitCode::kData, "trials.csv:1", text);
}

// A text that is no table has no line that could be half written.
TEST_F(StudyFolder, SomethingElseOfThatNameIsKept) {
    for (const char* text : {"notes", "notes\nmore notes"}) {
        std::ofstream(directory_ / "trials.csv", std::ios::binary) << text;
        expect_kept(ExitCode::kData, "trials.csv:1", text);
    }
}

TEST_F(StudyFolder, DamageInTheMiddleIsNamedNotCutOff) {
    write_first(1);
    append_text("trials.csv", "nonsense\n");
    expect_kept(ExitCode::kData, "trials.csv:3", table());
}

TEST(KeepLines, CutsWhatHasNoNewline) {
    const TemporaryDirectory directory;
    const auto path = directory / "table.csv";
    std::ofstream(path, std::ios::binary) << "header\n1\n2\n3";
    keep_lines(path, 100);
    EXPECT_EQ(read_text(path), "header\n1\n2\n");
    keep_lines(path, 1);
    EXPECT_EQ(read_text(path), "header\n1\n");
    keep_lines(path, 1);
    EXPECT_EQ(read_text(path), "header\n1\n");
    keep_lines(directory / "nothing.csv", 1);
    EXPECT_FALSE(std::filesystem::exists(directory / "nothing.csv"));
}

}  // namespace
}  // namespace thimble
