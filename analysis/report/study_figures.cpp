#include "analysis/report/study_figures.hpp"

#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/json_text.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

std::vector<FigureSource> figures_of(const StudyColumns& columns, const TrajectoryPanels& panels,
                                     const std::vector<TrialRow>& rows, const std::string& suffix) {
    const std::vector<Metric> metrics = measures_of(columns.experiment());
    return {trajectory_figure(panels.panels(), "trajectories" + suffix),
            bar_figure(summarize(of_experiment(rows, columns.experiment())), "bars" + suffix),
            subject_figure(columns, metrics, "subjects" + suffix),
            distribution_figure(columns, metrics, "distributions" + suffix),
            difference_figure(columns, metrics, "differences" + suffix)};
}

std::vector<FigureSource> side_by_side(const std::vector<StudyColumns>& columns,
                                       const PanelsByExperiment& panels) {
    return {all_trajectories_figure(panels, "trajectories_all"), all_bars_figure(columns, "bars_all")};
}

// Of all that was drawn, what was drawn from `sources`.
DrawnFigures part_of(const DrawnFigures& drawn, const std::vector<FigureSource>& sources) {
    DrawnFigures part;
    for (const FigureSource& source : sources) {
        if (source.script.empty()) continue;
        bool found = false;
        for (const Figure& figure : drawn.figures) {
            if (figure.name != source.name) continue;
            found = true;
            part.figures.push_back(figure);
        }
        if (!found) part.problem = drawn.problem;
    }
    return part;
}

std::string with_experiment(const MeasureAnalysis& measure) {
    return fmt::format("Experiment {}. {}", measure.experiment, finding_in_brief(measure));
}

}  // namespace

StudyFigures draw_study(const std::vector<TrialRow>& rows, const PanelsByExperiment& panels,
                        const std::filesystem::path& output) {
    const bool alone = panels.size() == 1;
    std::vector<StudyColumns> columns;
    std::map<std::uint32_t, std::vector<FigureSource>> sources;
    std::vector<FigureSource> all;
    for (const auto& [experiment, of_experiment] : panels) {
        columns.emplace_back(rows, experiment);
        sources[experiment] = figures_of(columns.back(), of_experiment, rows,
                                         alone ? "" : fmt::format("_experiment{}", experiment));
        all.insert(all.end(), sources[experiment].begin(), sources[experiment].end());
    }
    const auto together = alone ? std::vector<FigureSource>{} : side_by_side(columns, panels);
    all.insert(all.end(), together.begin(), together.end());

    const DrawnFigures drawn = draw_figures(all, output);
    StudyFigures figures{part_of(drawn, together), {}};
    for (const auto& [experiment, own] : sources) figures.experiments[experiment] = part_of(drawn, own);
    return figures;
}

ReportSection overview_section(const std::vector<MeasureAnalysis>& measures, DrawnFigures side_by_side) {
    ReportSection section;
    section.title = "The experiments side by side";
    for (const MeasureAnalysis& measure : measures) section.findings.push_back(with_experiment(measure));
    section.drawn = std::move(side_by_side);
    return section;
}

void add_analysis(ReportSection& section, const std::vector<TrialRow>& rows, std::uint32_t experiment,
                  const std::vector<MeasureAnalysis>& measures) {
    std::vector<MeasureAnalysis> own;
    for (const MeasureAnalysis& measure : measures) {
        if (measure.experiment == experiment) own.push_back(measure);
    }
    section.findings.push_back(stability_text(StudyColumns(rows, experiment)));
    for (const MeasureAnalysis& measure : own) section.findings.push_back(finding_text(measure));
    for (ReportTable& table : analysis_tables(own)) section.tables.push_back(std::move(table));
}

void write_analysis(const std::vector<MeasureAnalysis>& measures, AnalysisKind kind,
                    const std::filesystem::path& json) {
    write_text_file(json, json_text(to_json(measures, kind), 2) + "\n");
}

}  // namespace thimble
