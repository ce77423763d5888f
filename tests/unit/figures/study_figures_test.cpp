// The figures of studies that are small, lack something, or whose values are extreme.
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "analysis/report/report.hpp"
#include "tests/unit/analysis/gnuplot_or_none.hpp"
#include "tests/unit/analysis/modality_rows.hpp"
#include "tests/unit/figures/svg_picture.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

struct SmallStudy {
    std::vector<TrialRow> rows;
    PanelsByExperiment panels;
    std::vector<TrialRecord> records;

    void add(std::uint32_t experiment, Modality modality, double delay_s, std::uint32_t subject,
             double depth_m) {
        TrialRecord record = sine_record(depth_m, 0.1 * depth_m, 3);
        record.conditions.experiment = experiment;
        record.conditions.modality = modality;
        record.conditions.delay_s = delay_s;
        record.conditions.subject = subject;
        panels[experiment].add(record);
        records.push_back(record);
        TrialRow row = row_of(experiment, subject, static_cast<std::size_t>(modality), depth_m);
        row.conditions = record.conditions;
        if (experiment != 2) row.metrics.peak_displacement_m = std::nan("");
        rows.push_back(row);
    }

    void add(std::uint32_t experiment, const std::vector<Modality>& modalities,
             const std::vector<double>& delays_s, std::uint32_t subjects) {
        for (const Modality modality : modalities) {
            for (const double delay_s : delays_s) {
                for (std::uint32_t subject = 1; subject <= subjects; ++subject)
                    add(experiment, modality, delay_s, subject,
                        0.001 * (1 + static_cast<int>(modality)) + 0.0003 * subject +
                            0.0002 * (subject * subject * (2 + static_cast<std::uint32_t>(modality)) % 5));
            }
        }
    }

    // Experiment 1, in which every measure has this value.
    void add_all_of(double value) {
        add(1, {kModalities.begin(), kModalities.end()}, {0}, 4);
        for (TrialRow& row : rows) {
            const TrialConditions conditions = row.conditions;
            row = row_of(conditions.experiment, conditions.subject,
                         static_cast<std::size_t>(conditions.modality), value);
            row.conditions = conditions;
        }
    }
};

const std::vector<Modality> kAll(kModalities.begin(), kModalities.end());

struct Case {
    const char* name;
    std::function<void(SmallStudy&)> make;
    std::size_t figures;  // at least, of the first experiment
};

void PrintTo(const Case& of, std::ostream* out) { *out << of.name; }

const std::vector<double> kNow{0}, kLate{0.05}, kTwo{0, 0.05};
const std::vector<Modality> kAllButHF{Modality::kCF, Modality::kCCF, Modality::kVF};

const std::vector<Case> kCases{
    {"TenSubjects", [](SmallStudy& s) { s.add(3, kAll, kTwo, 10); }, 5},
    {"OneSubject", [](SmallStudy& s) { s.add(3, kAll, kTwo, 1); }, 4},
    {"OneTrial", [](SmallStudy& s) { s.add(3, Modality::kCF, 0.05, 1, 0.004); }, 4},
    {"OneTrialWithoutDelay", [](SmallStudy& s) { s.add(3, Modality::kHF, 0, 1, 0.004); }, 2},
    {"NoHF", [](SmallStudy& s) { s.add(3, kAllButHF, kLate, 10); }, 5},
    {"OnlyHF", [](SmallStudy& s) { s.add(3, {Modality::kHF}, kLate, 4); }, 4},
    {"TwoModalities",
     [](SmallStudy& s) {
         s.add(3, {Modality::kHF, Modality::kVF}, kLate, 10);
     },
     5},
    {"SevenDelays",
     [](SmallStudy& s) {
         s.add(3, kAll, {0, 0.005, 0.01, 0.025, 0.05, 0.1, 0.2}, 2);
     },
     4},
    {"AHoleInTheGrid",
     [](SmallStudy& s) {
         s.add(3, {Modality::kVF}, kNow, 2);
         s.add(3, {Modality::kHF, Modality::kCF}, kLate, 2);
     },
     4},
    {"AllValuesEqual", [](SmallStudy& s) { s.add_all_of(0.004); }, 4},
    {"AllValuesZero", [](SmallStudy& s) { s.add_all_of(0); }, 4},
    {"NoMeasureAtAll", [](SmallStudy& s) { s.add_all_of(std::nan("")); }, 4},
    {"NobodyCompletes",
     [](SmallStudy& s) {
         s.add(3, kAll, kLate, 10);
         for (TrialRow& row : s.rows) row.metrics.completion_time_s = std::nan("");
     },
     5},
    {"BelowZero", [](SmallStudy& s) { s.add_all_of(-0.002); }, 4},
    {"FarOut",
     [](SmallStudy& s) {
         s.add(1, kAll, kNow, 4);
         s.add(1, Modality::kHF, 0, 5, 4);
     },
     4},
    {"TrialsThatNeverEnter",
     [](SmallStudy& s) {
         s.add(1, Modality::kCF, 0, 1, 0.004);
         TrialRecord record = sine_record(0.004, 0, 1);
         for (TrajectorySample& sample : record.samples) sample.phase = TissuePhase::kFree;
         record.conditions.experiment = 1;
         s.panels[1].add(record);
     },
     4},
    {"Removal", [](SmallStudy& s) { s.add(2, kAll, kNow, 10); }, 5},
    {"ACompensatorWithALongName",
     [](SmallStudy& s) {
         s.add(3, {Modality::kHF, Modality::kCF}, kLate, 10);
         for (std::size_t i = 0; i < 10; ++i) {
             TrialRow row = s.rows[i];
             row.conditions.compensator = Compensator::kMemorylessBound;
             row.metrics.penetration_max_m *= 0.5;
             s.rows.push_back(row);
         }
     },
     5}};

class StudyPictures : public testing::TestWithParam<Case> {
  protected:
    void SetUp() override {
        if (!have_gnuplot()) GTEST_SKIP() << "gnuplot is not installed (package gnuplot-nox)";
    }
};

TEST_P(StudyPictures, HaveNothingToStumbleOver) {
    SmallStudy study;
    GetParam().make(study);
    const TemporaryDirectory folder;
    const StudyFigures drawn = draw_study(study.rows, study.panels, folder.path());
    const DrawnFigures& own = drawn.experiments.begin()->second;
    EXPECT_EQ(own.problem, "");
    EXPECT_GE(own.figures.size(), GetParam().figures);
    for (const Figure& figure : own.figures) {
        const SvgPicture picture(figure.svg);
        EXPECT_EQ(picture.faults(), "") << figure.name;
        EXPECT_TRUE(picture.says("n = ") || figure.name.starts_with("differences")) << figure.name;
        EXPECT_THAT(figure.caption, HasSubstr(figure.name.starts_with("trajectories") ? "n = " : "n"))
            << figure.name;
    }
}

INSTANTIATE_TEST_SUITE_P(Of, StudyPictures, testing::ValuesIn(kCases),
                         [](const auto& of) { return std::string(of.param.name); });

TEST(ExperimentsSideBySide, HaveNothingToStumbleOver) {
    if (!have_gnuplot()) GTEST_SKIP() << "gnuplot is not installed (package gnuplot-nox)";
    SmallStudy study;
    study.add(1, {Modality::kCF, Modality::kVF}, {0}, 2);
    study.add(2, {Modality::kHF}, {0}, 1);
    study.add(3, kAll, {0, 0.05}, 3);
    const TemporaryDirectory folder;
    const StudyFigures drawn = draw_study(study.rows, study.panels, folder.path());
    EXPECT_EQ(drawn.side_by_side.problem, "");
    ASSERT_EQ(drawn.side_by_side.figures.size(), 2U);
    for (const Figure& figure : drawn.side_by_side.figures)
        EXPECT_EQ(SvgPicture(figure.svg).faults(), "") << figure.name;
}

const Figure& figure_named(const DrawnFigures& drawn, const std::string& name) {
    return *std::find_if(drawn.figures.begin(), drawn.figures.end(),
                         [&](const Figure& figure) { return figure.name == name; });
}

// Warm and cold as in the windows, on the light ground.
TEST(TrajectoryPicture, HasTheColoursOfNeedleAndSurface) {
    if (!have_gnuplot()) GTEST_SKIP() << "gnuplot is not installed (package gnuplot-nox)";
    SmallStudy study;
    study.add(3, kAll, {0.05}, 2);
    const TemporaryDirectory folder;
    const StudyFigures drawn = draw_study(study.rows, study.panels, folder.path());
    const std::string& svg = figure_named(drawn.experiments.at(3), "trajectories").svg;
    EXPECT_THAT(svg, HasSubstr("rgb(213,  94,   0)"));
    EXPECT_THAT(svg, HasSubstr("rgb(  0, 114, 178)"));
    EXPECT_THAT(trajectory_figure(study.panels.at(3).panels(), "t").script,
                testing::AllOf(HasSubstr("linecolor '#D55E00' title 'needle"),
                               HasSubstr("linecolor '#0072B2' title 'surface")));
}

// The paper's axes and order, and the stretched ones on request.
TEST(TrajectoryPicture, SaysWhatItsAxesAre) {
    SmallStudy study;
    study.add(3, kAll, {0.05}, 3);
    const FigureSource paper = trajectory_figure(study.panels.at(3).panels(), "t");
    EXPECT_THAT(paper.script, testing::AllOf(HasSubstr("time from contact (s)"), HasSubstr("n = 3 subjects"),
                                             HasSubstr(" contact }' at 0,")));
    EXPECT_LT(paper.script.find(":Bold VF"), paper.script.find(":Bold HF"));
    EXPECT_LT(paper.script.find(":Bold HF"), paper.script.find(":Bold CF"));
    EXPECT_LT(paper.script.find(":Bold CF"), paper.script.find(":Bold CCF"));
    EXPECT_THAT(paper.caption, HasSubstr("n = 3 subjects, whose trials are averaged first,"));

    TrajectoryPanels stretched(kPercentGrid);
    for (const TrialRecord& record : study.records) stretched.add(record);
    const FigureSource percent = trajectory_figure(stretched.panels(), "t");
    EXPECT_THAT(percent.script, testing::AllOf(HasSubstr("entry to beep (%)"), HasSubstr("xrange [-10:110]"),
                                               HasSubstr(" beep }' at 100,")));
    EXPECT_THAT(percent.caption, HasSubstr("time is stretched"));
}

TEST(BarPicture, SaysHowManyAndWhatTheWhiskersAre) {
    if (!have_gnuplot()) GTEST_SKIP() << "gnuplot is not installed (package gnuplot-nox)";
    SmallStudy study;
    study.add(3, kAll, {0, 0.05}, 3);
    study.add(3, Modality::kCF, 0.05, 4, 0.00002);
    study.rows.back().metrics.completion_time_s = std::nan("");
    const TemporaryDirectory folder;
    const DrawnFigures drawn = draw_study(study.rows, study.panels, folder.path()).experiments.at(3);
    const Figure& bars = figure_named(drawn, "bars");
    const SvgPicture picture(bars.svg);
    EXPECT_TRUE(picture.says("n = 3-4"));
    EXPECT_TRUE(picture.says("± SD over n subjects"));
    EXPECT_THAT(bars.caption, HasSubstr("± one standard deviation over these subjects"));
    EXPECT_GE(picture.areas().size(), 2U * 4 * 2);
}

TEST(BarPicture, NamesTheValueOfABarTooLowToBeSeen) {
    if (!have_gnuplot()) GTEST_SKIP() << "gnuplot is not installed (package gnuplot-nox)";
    SmallStudy study;
    study.add(2, Modality::kHF, 0, 1, 0.04);
    study.add(2, Modality::kCF, 0, 1, 0.00006);
    const TemporaryDirectory folder;
    const DrawnFigures drawn = draw_study(study.rows, study.panels, folder.path()).experiments.at(2);
    EXPECT_TRUE(SvgPicture(figure_named(drawn, "bars").svg).says("0.06"));
}

}  // namespace
}  // namespace thimble
