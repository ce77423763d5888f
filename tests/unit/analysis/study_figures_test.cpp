// The data of figures, and that gnuplot draws them.
#include <array>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "analysis/figures/measure_axes.hpp"
#include "analysis/report/report.hpp"
#include "analysis/text/gnuplot.hpp"
#include "tests/unit/analysis/gnuplot_or_none.hpp"
#include "tests/unit/analysis/modality_rows.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::vector<Metric> kOne{Metric::kPenetrationMean};
constexpr std::array<double, 4> kMeans{0.001, 0.004, 0.0055, 0.008};

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) {
        if (!line.empty() && line[0] != '#') lines.push_back(line);
    }
    return lines;
}

TEST(SubjectFigure, HasALinePerModalityWithEverySubject) {
    Columns columns = normal_columns(3, kMeans);
    columns[1] = {0.002, std::nan(""), 0.004};
    const FigureSource figure = subject_figure(StudyColumns(rows_of(columns), 1), kOne, "s");
    const auto lines = lines_of(figure.data);
    ASSERT_EQ(lines.size(), 4U);
    EXPECT_EQ(lines[1], "1\t3\t2\tNaN\t4");  // place, mean of those there are, subjects; in mm
    EXPECT_THAT(figure.script, HasSubstr("for [subject=3:5]"));
    EXPECT_TRUE(subject_figure(StudyColumns({}, 1), kOne, "s").script.empty());
}

TEST(DistributionFigure, HasEveryTrialAndItsModalitysBox) {
    Columns columns;
    columns.fill({0.001, 0.002, 0.003, 0.004, 0.1});
    const FigureSource figure = distribution_figure(StudyColumns(rows_of(columns), 1), kOne, "d");
    const auto lines = lines_of(figure.data);
    ASSERT_EQ(lines.size(), 4U + 1 + 4 * 5 + 1);
    // Place, quartile, whisker, whisker (not to the outlier), quartile, median, mean.
    EXPECT_EQ(lines[2], "1.8\t2\t1\t4\t4\t3\t22");
    for (std::size_t i = 0; i < 5; ++i) {  // CF's points keep to their side of the place
        const double x = std::stod(lines[5 + 5 + i]);
        EXPECT_GT(x, 1.0);
        EXPECT_LT(x, 1.35);
    }
}

TEST(DifferenceFigure, ShowsTheIntervalsOfTheFindings) {
    const StudyColumns columns(rows_of(normal_columns(9, kMeans)), 1);
    const FigureSource figure = difference_figure(columns, kOne, "d");
    const LocationShift shift = *compare_conditions(columns, kOne[0])[0].shift;
    EXPECT_EQ(lines_of(figure.data)[0], fmt::format("0\t{:.6g}\t{:.6g}\t{:.6g}", 1e3 * shift.estimate,
                                                    1e3 * shift.interval->low, 1e3 * shift.interval->high));
    EXPECT_EQ(lines_of(figure.data).size(), 2 * (3 + 3 * 9 + 1U));
    EXPECT_THAT(figure.script, HasSubstr("'HF − CF' 0"));
}

TEST(DifferenceFigure, IsLeftOutWhereNothingCanBeTested) {
    EXPECT_TRUE(
        difference_figure(StudyColumns(rows_of(normal_columns(1, kMeans)), 1), kOne, "d").script.empty());
    Columns columns = normal_columns(9, kMeans);
    columns[1].clear();
    columns[2].clear();
    columns[3].clear();
    EXPECT_TRUE(difference_figure(StudyColumns(rows_of(columns), 1), kOne, "d").script.empty());
    EXPECT_TRUE(draw_figures(std::vector<FigureSource>(2), "/nowhere").problem.empty());
}

// Two subjects have an estimate, and no interval.
TEST(DifferenceFigure, HasNoIntervalOfTooFewSubjects) {
    const FigureSource figure =
        difference_figure(StudyColumns(rows_of(normal_columns(2, kMeans)), 1), kOne, "d");
    std::istringstream first(lines_of(figure.data)[0]);
    double y = 0, estimate = 0, low = 0, high = 0;
    first >> y >> estimate >> low >> high;
    EXPECT_NE(estimate, 0);
    EXPECT_EQ(low, estimate);
    EXPECT_EQ(high, estimate);
    EXPECT_THAT(figure.caption, HasSubstr("too few for a test have no interval"));
    EXPECT_THAT(figure.script, Not(HasSubstr("confidence interval")));
}

// Without HF, and with two modalities: one pair, and no interval for several.
TEST(DifferenceFigure, ComparesTheModalitiesThatThereAre) {
    Columns columns = normal_columns(9, kMeans);
    columns[0].clear();
    columns[2].clear();
    const FigureSource figure = difference_figure(StudyColumns(rows_of(columns), 1), kOne, "d");
    EXPECT_EQ(lines_of(figure.data).size(), 1 + 9 + 1U);
    EXPECT_THAT(figure.script, testing::AllOf(HasSubstr("'CF − VF' 0"), Not(HasSubstr("at once"))));
    EXPECT_THAT(figure.caption, HasSubstr("n = 9 subjects"));
}

TEST(NiceStep, IsOneTwoOrFiveAndFewEnough) {
    EXPECT_DOUBLE_EQ(nice_step(10, 5), 2);
    EXPECT_DOUBLE_EQ(nice_step(11, 5), 5);
    EXPECT_DOUBLE_EQ(nice_step(0.9, 10), 0.1);
    EXPECT_DOUBLE_EQ(nice_step(60, 6), 10);
}

TEST(BarFigure, ShowsTheJumpWhereTheFixtureWasRemoved) {
    auto rows = rows_of(normal_columns(3, kMeans));
    EXPECT_THAT(bar_figure(summarize(rows), "b").script, HasSubstr("peak displacement"));
    for (TrialRow& row : rows) row.metrics.peak_displacement_m = std::nan("");
    EXPECT_THAT(bar_figure(summarize(rows), "b").script,
                testing::AllOf(HasSubstr("maximum penetration"), Not(HasSubstr("displacement"))));
}

TEST(MeasureAxis, IsLogarithmicOnlyForFarOutPositiveValues) {
    EXPECT_FALSE(wants_logarithm(std::array{1.0, 2.0, 3.0, 9.0}));
    EXPECT_TRUE(wants_logarithm(std::array{1.0, 2.0, 3.0, 90.0, std::nan("")}));
    EXPECT_FALSE(wants_logarithm(std::array{0.0, 2.0, 3.0, 90.0}));
    EXPECT_FALSE(wants_logarithm(std::array{std::nan("")}));
    EXPECT_THAT(measure_axis(kOne[0], std::array{-0.001, 0.002}), HasSubstr("set yrange [-1.18:2.18]"));
    EXPECT_THAT(measure_axis(kOne[0], std::array{0.001, 0.002}), HasSubstr("set yrange [0:2.12]"));
    EXPECT_THAT(measure_axis(kOne[0], std::array{std::nan("")}), HasSubstr("set yrange [0:1.06]"));
}

struct ThreeExperiments {
    std::vector<TrialRow> rows;
    PanelsByExperiment panels;

    ThreeExperiments() {
        for (const std::uint32_t experiment : {1U, 2U, 3U}) {
            const auto more = rows_of(normal_columns(4, kMeans), experiment);
            rows.insert(rows.end(), more.begin(), more.end());
            for (const Modality modality : kModalities) {
                TrialRecord record = sine_record(0.004, 0.0005, 0.7);
                record.conditions.experiment = experiment;
                record.conditions.modality = modality;
                record.conditions.delay_s = experiment == 3 ? 0.05 : 0;
                panels[experiment].add(record);
            }
        }
    }
};

TEST(StudyFigures, AreDrawnAsSvgAndPdf) {
    if (!have_gnuplot()) GTEST_SKIP() << "gnuplot is not installed (package gnuplot-nox)";
    const TemporaryDirectory directory;
    const ThreeExperiments study;
    const StudyFigures figures = draw_study(study.rows, study.panels, directory.path());
    EXPECT_EQ(figures.side_by_side.problem, "");
    ASSERT_EQ(figures.side_by_side.figures.size(), 2U);
    for (const std::uint32_t experiment : {1U, 2U, 3U}) {
        const DrawnFigures& own = figures.experiments.at(experiment);
        EXPECT_EQ(own.problem, "");
        ASSERT_EQ(own.figures.size(), 5U);
        for (const Figure& figure : own.figures) {
            EXPECT_TRUE(figure.name.ends_with(fmt::format("_experiment{}", experiment)));
            const std::string pdf = read_text(directory / "figures" / (figure.name + ".pdf"));
            EXPECT_TRUE(pdf.starts_with("%PDF")) << figure.name;
            EXPECT_THAT(figure.svg, Not(HasSubstr("<?xml")));
        }
    }
    const std::string before = read_text(directory / "figures" / "bars_all.pdf");
    draw_study(study.rows, study.panels, directory.path());
    EXPECT_EQ(read_text(directory / "figures" / "bars_all.pdf"), before);
}

TEST(StudyFigures, WithoutGnuplotEverySectionSaysSo) {
    const TemporaryDirectory directory;
    const ThreeExperiments study;
    StudyFigures figures;
    {
        const Path nothing(directory.path().string());
        figures = draw_study(study.rows, study.panels, directory.path());
    }
    EXPECT_THAT(figures.side_by_side.problem, HasSubstr("install gnuplot"));
    for (const auto& [experiment, own] : figures.experiments) {
        EXPECT_THAT(own.problem, HasSubstr("install gnuplot")) << experiment;
        EXPECT_TRUE(own.figures.empty());
    }
    EXPECT_TRUE(std::filesystem::exists(directory / "figures" / "bars_all.gp"));
}

// Figures drawn before the failing one are kept.
TEST(DrawFigures, OneThatFailsDoesNotTakeTheOthersAlong) {
    if (!have_gnuplot()) GTEST_SKIP() << "gnuplot is not installed (package gnuplot-nox)";
    const TemporaryDirectory directory;
    const std::string good = gnuplot_preamble("good", 300, 200) + "plot 'good.tsv' using 1:2\n";
    const std::string bad = gnuplot_preamble("bad", 300, 200) + "plod\n";
    const DrawnFigures drawn =
        draw_figures({{"good", "", "", "1 2\n", good}, {"bad", "", "", "1 2\n", bad}}, directory.path());
    ASSERT_EQ(drawn.figures.size(), 1U);
    EXPECT_EQ(drawn.figures[0].name, "good");
    EXPECT_THAT(drawn.problem, testing::AllOf(HasSubstr("not drawn: bad"), HasSubstr("plod")));
}

// Trials of several delays are not averaged: each delay has figures of its own.
TEST(StudyFigures, SeveralDelaysAreDrawnApart) {
    const TemporaryDirectory directory;
    std::vector<TrialRow> rows;
    PanelsByExperiment panels;
    for (const double delay_s : {0.0, 0.02, 0.05}) {
        for (TrialRow row : rows_of(normal_columns(4, kMeans), 3)) {
            row.conditions.delay_s = delay_s;
            rows.push_back(row);
        }
    }
    TrialRecord record = sine_record(0.004, 0.0005, 0.7);
    record.conditions.experiment = 3;
    panels[3].add(record);
    const Path nothing(directory.path().string());
    draw_study(rows, panels, directory.path());
    for (const char* name : {"subjects_20ms.tsv", "distributions_50ms.tsv", "trajectories.tsv"})
        EXPECT_TRUE(std::filesystem::exists(directory / "figures" / name)) << name;
    EXPECT_FALSE(std::filesystem::exists(directory / "figures" / "subjects.tsv"));
    std::erase_if(rows, [](const TrialRow& row) { return row.conditions.delay_s > 0; });
    draw_study(rows, panels, directory.path());  // without delay, where there is nothing else
    EXPECT_TRUE(std::filesystem::exists(directory / "figures" / "subjects.tsv"));
}

}  // namespace
}  // namespace thimble
