#include "analysis/report/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "analysis/report/report_tables.hpp"
#include "analysis/text/gnuplot.hpp"
#include "common/error.hpp"
#include "common/process/child.hpp"
#include "tests/unit/analysis/gnuplot_or_none.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

struct Study {
    std::vector<TrialRow> rows;
    TrajectoryPanels panels;
};

// Two subjects, two trials per modality and delay; HF leaves the fixture at 50 ms.
Study small_study() {
    Study study;
    for (std::uint32_t trial = 1; trial <= 32; ++trial) {
        const Modality modality = kModalities[trial % 4];
        const double delay_s = trial > 16 ? 0.05 : 0;
        const bool oscillates = delay_s > 0 && modality == Modality::kHF;
        TrialRecord record = oscillates ? sine_record(0.001, 0.01 + 0.0001 * trial, 3)
                                        : sine_record(0.004 + 0.00005 * trial, 0.0005, 0.7);
        record.conditions.subject = 1 + (trial / 4) % 2;
        record.conditions.trial = trial;
        record.conditions.modality = modality;
        record.conditions.delay_s = delay_s;
        study.rows.push_back(make_row(record));
        study.panels.add(record);
    }
    return study;
}

std::size_t count(const std::string& text, const std::string& what) {
    std::size_t n = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
    return n;
}

TEST(Report, StandsAloneWithInlineFigures) {
    if (!have_gnuplot()) GTEST_SKIP() << "gnuplot is not installed (package gnuplot-nox)";
    const TemporaryDirectory directory;
    const Study study = small_study();
    ReportInput report{"A <study>", {}, {{"seed", "1"}, {"command", "thimble study \"x\" & y"}}};
    DrawnFigures drawn = draw_figures(study.panels.panels(), summarize(study.rows), directory.path());
    ASSERT_EQ(drawn.problem, "");
    const auto findings = findings_of(study.rows);
    report.sections.push_back(trials_section("Virtual time", study.rows, findings, std::move(drawn)));
    report.sections.push_back({"Nothing was measured", "", {}, {}, {}, {{"Empty", "", {"one"}, {}}}});
    report.answers = {{"", answer(findings)}};
    write_report(report, directory / "report.html");

    const std::string html = read_text(directory / "report.html");
    EXPECT_EQ(count(html, "<svg"), 2U);
    EXPECT_EQ(count(html, "</svg>"), 2U);
    EXPECT_EQ(count(html, "http://"), count(html, "xmlns=\"http://") + count(html, "xmlns:xlink=\"http://"));
    for (const char* outside : {"https://", "<script", "<link", "<img", "@import", "src=", "<?xml"}) {
        EXPECT_EQ(count(html, outside), 0U) << outside;
    }
    // Answer, legend, figures, statistics; nothing empty.
    std::size_t before = 0;
    for (const char* part :
         {"At 50 ms HF oscillates in 4 of 4 trials", "<dt>HF</dt>", "<h2>Figures: Virtual time</h2>", "<svg",
          "Which conditions oscillate", "<h3>Differences</h3>", "Provenance"}) {
        EXPECT_EQ(count(html, part) > 0, true) << part;
        EXPECT_GT(html.find(part), before) << part;
        before = html.find(part);
    }
    for (const char* absent : {"not judged", "supported", "Empty", "Nothing was measured"})
        EXPECT_EQ(count(html, absent), 0U) << absent;
    EXPECT_EQ(count(html, "A &lt;study&gt;"), 2U);
    EXPECT_EQ(count(html, "thimble study &quot;x&quot; &amp; y"), 1U);
    for (const char* file : {"trajectories.svg", "trajectories.gp", "trajectories.tsv", "bars.svg"}) {
        EXPECT_TRUE(std::filesystem::exists(directory / "figures" / file)) << file;
    }
}

TEST(Report, FiguresKeepTheirIdsApart) {
    if (!have_gnuplot()) GTEST_SKIP() << "gnuplot is not installed (package gnuplot-nox)";
    const TemporaryDirectory directory;
    const Study study = small_study();
    const DrawnFigures drawn =
        draw_figures(study.panels.panels(), summarize(study.rows), directory.path(), "_real");
    ASSERT_EQ(drawn.figures.size(), 2U);
    for (const Figure& figure : drawn.figures) {
        EXPECT_TRUE(figure.name.ends_with("_real"));
        EXPECT_GT(count(figure.svg, "id=\"" + figure.name + "-"), 0U);
        EXPECT_EQ(count(figure.svg, "id=\""), count(figure.svg, "id=\"" + figure.name + "-"));
        EXPECT_EQ(count(figure.svg, "href='#"), count(figure.svg, "href='#" + figure.name + "-"));
    }
}

void draw_bars(const std::filesystem::path& folder) {
    const FigureSource bars = bar_figure(summarize(small_study().rows), "bars");
    run_gnuplot(folder, bars.name, bars.data, bars.script);
}

TEST(Report, WithoutGnuplotTheTablesRemain) {
    const TemporaryDirectory directory;
    const Study study = small_study();
    const auto conditions = summarize(study.rows);
    DrawnFigures drawn;
    {
        const Path nothing(directory.path().string());
        EXPECT_THAT(refusal([&] { draw_bars(directory / "figures"); }, ExitCode::kRunFailed),
                    HasSubstr("install gnuplot"));
        drawn = draw_figures(study.panels.panels(), conditions, directory.path());
    }
    EXPECT_TRUE(drawn.figures.empty());
    ReportInput report{
        "Study", {trials_section("Virtual time", study.rows, findings_of(study.rows), drawn)}, {}};
    write_report(report, directory / "report.html");
    write_summary(report, directory / "summary.json");
    const std::string html = read_text(directory / "report.html");
    EXPECT_EQ(count(html, "No figures: cannot start gnuplot"), 1U);
    EXPECT_EQ(count(html, "<table>"), 4U);
    EXPECT_THAT(read_text(directory / "summary.json"), HasSubstr("figures_problem"));
}

TEST(Report, AFailingGnuplotSaysWhy) {
    const TemporaryDirectory directory;
    std::ofstream(directory / "gnuplot") << "#!/bin/sh\necho no such terminal >&2\nexit 3\n";
    std::filesystem::permissions(directory / "gnuplot", std::filesystem::perms::owner_all);
    const Path fake(directory.path().string());
    EXPECT_THAT(refusal([&] { draw_bars(directory / "figures"); }, ExitCode::kRunFailed),
                testing::AllOf(HasSubstr("exit code 3"), HasSubstr("no such terminal")));
}

TEST(Report, SummaryHasTheNumbersOfTheTables) {
    const TemporaryDirectory directory;
    const Study study = small_study();
    ReportInput report{
        "Study", {trials_section("Virtual time", study.rows, findings_of(study.rows), {})}, {{"seed", "1"}}};
    report.answers = {{"", {"One.", "Two.", "Three."}}};
    report.provenance.emplace_back(kDesign, "paper-experiment-3");
    EXPECT_EQ(design_in(directory.path()), std::nullopt);
    write_summary(report, directory / "summary.json");
    const auto summary = nlohmann::json::parse(read_text(directory / "summary.json"));
    const auto& section = summary["sections"][0];
    EXPECT_EQ(summary["answer"].dump(), R"(["One.","Two.","Three."])");
    EXPECT_EQ(design_in(directory.path()), "paper-experiment-3");
    EXPECT_EQ(summary["provenance"]["seed"], "1");
    ASSERT_EQ(section["conditions"].size(), 8U);
    const auto& condition = section["conditions"][4];
    EXPECT_EQ(condition["modality"], "HF");
    EXPECT_EQ(condition["delay_s"], 0.05);
    EXPECT_EQ(condition["oscillating"], 4);
    EXPECT_EQ(condition["judged"], 4);
    EXPECT_DOUBLE_EQ(condition["metrics"]["penetration_max_m"]["mean"].get<double>(),
                     report.sections[0].conditions[4].of(Metric::kPenetrationMax).mean);
    EXPECT_TRUE(condition["metrics"]["peak_displacement_m"]["mean"].is_null());
}

TEST(Report, SaysEverywhereThatTheSubjectsAreVirtualAndFoldsFiles) {
    const TemporaryDirectory directory;
    ReportSection section;
    section.drawn.figures.push_back({"bars", "Bars", "Means.", "<svg></svg>"});
    ReportInput report{"Study", {section}, {{"session file x.toml", "[session]\nsubject = 1 # <1>\n"}}};
    report.answers = {{"", {"One."}}};
    say_virtual_subjects(report);
    write_report(report, directory / "report.html");
    const std::string html = read_text(directory / "report.html");
    EXPECT_EQ(count(html, "Study, virtual subjects"), 2U) << "title and heading";
    EXPECT_LT(html.find("The subjects are virtual"), html.find("One."));
    EXPECT_EQ(count(html, "<figcaption>Means. Virtual subjects.</figcaption>"), 1U);
    EXPECT_EQ(count(html, "<summary>session file x.toml</summary>"), 1U);
    EXPECT_EQ(count(html, "<pre>[session]\nsubject = 1 # &lt;1&gt;\n</pre>"), 1U);
    EXPECT_EQ(count(html, "kind of subjects"), 1U);
    report.answers.clear();
    report.sections.front().text = "Two.";
    say_virtual_subjects(report);
    EXPECT_TRUE(report.sections.front().text.starts_with("The subjects are virtual")) << "without an answer";
}

TEST(Report, SummaryHoldsAPathThatIsNoUtf8AsFarAsItGoes) {
    const TemporaryDirectory directory;
    ReportInput report{"Study", {}, {{"command", "thimble study --out caf\xe9"}, {"\xff", "1"}}};
    write_summary(report, directory / "summary.json");
    const auto summary = nlohmann::json::parse(read_text(directory / "summary.json"));
    EXPECT_EQ(summary["provenance"]["command"], "thimble study --out caf\xef\xbf\xbd");
}

// The page shows the summary's numbers, not those of a changed table.
TEST(Report, ATableThatWasChangedSinceIsRefused) {
    const TemporaryDirectory directory;
    const auto report_of = [&] {
        return write_combined_report(directory.path(), {}, directory / "report.html", "thimble report");
    };
    write_text(directory / "trials.csv", "a\n1\n");
    write_summary({"Run", {}, {{kDesign, kUsersDesign}}, {}, RunTime{"wall"}}, directory / "summary.json");
    report_of();
    EXPECT_THAT(
        read_text(directory / "summary.json"),
        HasSubstr(
            "309b0e45a73d3fc5325e2b6ed0a01ef8b9cde6b05a5633c1f893f970d52bfddc"));  // as sha256sum has it
    write_text(directory / "trials.csv", "a\n2\n");
    EXPECT_THAT(refusal(report_of), HasSubstr("trials.csv: was changed since summary.json was written"));
    std::filesystem::remove(directory / "trials.csv");
    EXPECT_THAT(refusal(report_of), HasSubstr("trials.csv: is gone"));
}

// Its page says of each folder how its trials were run.
TEST(Report, AFolderOfAnotherCommandIsRefusedAndVirtualTimeNamed) {
    const TemporaryDirectory directory;
    const auto folder_of = [&](const std::string& name, const Provenance& provenance,
                               const std::optional<RunTime>& time) {
        std::filesystem::create_directory(directory / name);
        write_summary({name, {}, provenance, {{"", {"One."}}}, time}, directory / name / "summary.json");
        return directory / name;
    };
    const Provenance design{{kDesign, kUsersDesign}};
    const auto wall = folder_of("wall", design, RunTime{"wall"}),
               lock_step = folder_of("lock_step", design, RunTime{"lock-step"}),
               virtual_run = folder_of("virtual", design, RunTime{"virtual"}),
               study = folder_of("study", design, {}), other = folder_of("compensators", {}, {});
    const auto report_of = [&](const std::filesystem::path& run, const std::filesystem::path& of_study) {
        std::vector<std::string> titles;
        for (const Answer& a : write_combined_report(run, of_study, directory / "report.html", ""))
            titles.push_back(a.of);
        return titles;
    };
    EXPECT_THAT(report_of(wall, study), testing::ElementsAre("Virtual study", "Real processes"));
    EXPECT_THAT(report_of(lock_step, {}), testing::ElementsAre("Real processes"));
    EXPECT_THAT(report_of(virtual_run, {}), testing::ElementsAre("Virtual time"));
    for (const auto& [run, of_study] : {std::pair(study, std::filesystem::path{}),
                                        {{}, wall},
                                        {{}, virtual_run},
                                        {other, {}},
                                        {{}, other}}) {
        EXPECT_THAT(refusal([&, &named = run, &as_study = of_study] { report_of(named, as_study); },
                            ExitCode::kUsage),
                    HasSubstr((run.empty() ? of_study : run).string() + ": thimble "));
    }
}

TEST(Report, AgreementComparesTheSameTrials) {
    const Study study = small_study();
    std::vector<TrialRow> real = study.rows;
    real[0].metrics.penetration_max_m += 0.001;
    real[31].metrics.oscillates = !real[31].metrics.oscillates;
    real[5].reason = EndReason::kPeerLost;
    real[6].conditions.subject = 99;
    const Agreement agreement = compare_trials(real, study.rows);
    EXPECT_EQ(agreement.compared, 30U);
    EXPECT_EQ(agreement.same_class, 29U);
    EXPECT_EQ(agreement.unmatched, 2U);
    EXPECT_EQ(agreement.classes.rows.size(), 30U);
    EXPECT_EQ(agreement.classes.rows.back().back(), "no");
    ASSERT_EQ(agreement.metrics.rows.size(), 14U);  // those without delay
    EXPECT_EQ(agreement.metrics.rows[0].at(9), "1.00");
    const ReportSection section = agreement_section(real, study.rows);
    EXPECT_EQ(section.text.find("The class agrees in 29 of 30 trials"), 0U);
}

TEST(Subprocess, OutputExitCodeAndDirectory) {
    const TemporaryDirectory directory;
    const ProgramResult result =
        run_program("sh", {"-c", "pwd; echo oops >&2; exit 7"}, directory.path(), "");
    EXPECT_EQ(result.exit_code, 7);
    EXPECT_EQ(result.output, std::filesystem::canonical(directory.path()).string() + "\noops\n");
    EXPECT_EQ(run_program("sh", {"-c", "kill -9 $$"}, ".", "").exit_code, 128 + 9);
    EXPECT_EQ(run_program("cat", {}, ".", "").output, "");  // stdin is empty, not the terminal
}

}  // namespace
}  // namespace thimble
