#include "study/compensators/compensator_report.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/json_text.hpp"
#include "common/text_file.hpp"
#include "common/version.hpp"
#include "study/compensators/compensator_table.hpp"

namespace thimble {
namespace {

constexpr double kJitter_s = 0.005, kLoss = 0.05, kDelay_s = 0.05;

ReportTable table_of(const std::vector<CompensatorRow>& rows, std::string title, std::string note,
                     const std::function<std::string(const CompensatorRow&)>& cell) {
    ReportTable table{std::move(title), std::move(note), {"condition"}};
    const std::vector<CompensatorNetwork> networks = networks_in(rows);
    for (const CompensatorNetwork& network : networks) table.columns.push_back(network.name);
    for (const std::string& condition : conditions_in(rows)) {
        std::vector<std::string> line{condition};
        for (const CompensatorNetwork& network : networks) {
            const CompensatorRow* const row = find_row(rows, condition, network.name);
            line.push_back(row != nullptr ? cell(*row) : std::string(kDash));
        }
        table.rows.push_back(std::move(line));
    }
    return table;
}

std::vector<ReportTable> tables_of(const std::vector<CompensatorRow>& rows) {
    std::vector<ReportTable> tables;
    tables.push_back(
        table_of(rows, "Completed, oscillating",
                 "Number of trials of each cell that were completed, and number that oscillated.",
                 [](const CompensatorRow& row) {
                     return fmt::format("{}, {} of {}", row.completed, row.oscillating, row.trials);
                 }));
    for (const CompensatorMeasure& measure : compensator_measures()) {
        if (measure.name == "oscillating") continue;
        tables.push_back(
            table_of(rows, std::string(measure.label), "Mean over trials.", [&](const CompensatorRow& row) {
                const double value = measure.value(row);
                return std::isfinite(value) ? fmt::format("{:.{}f}", value, measure.decimals)
                                            : std::string(kDash);
            }));
    }
    tables.push_back(table_of(
        rows, "Share of the force for the hand",
        "For scaled alone: 0.8 of the share at which the linear loop of the nominal hand becomes unstable.",
        [](const CompensatorRow& row) {
            return std::isfinite(row.share) ? fmt::format("{:.3f}", row.share) : std::string(kDash);
        }));
    return tables;
}

ReportSection comparison_section(const std::vector<CompensatorRow>& rows,
                                 const std::vector<std::string>& findings,
                                 const CompensatorStudyOptions& options, const std::filesystem::path& out) {
    ReportSection section;
    section.title = "Experiment 3 with compensators";
    section.text = fmt::format(
        "The virtual operator inserts the needle, stops at the fixture and keeps contact for five seconds: "
        "{} subjects with {} trials each per condition and network. Subjects and fixtures are the same in "
        "all conditions. Compensators act in HF.",
        options.subjects, options.trials);
    section.findings = findings;
    std::vector<FigureSource> sources{matrix_figure(rows)};
    for (FigureSource& source : delay_figures(rows)) sources.push_back(std::move(source));
    section.drawn = draw_figures(sources, out);
    section.tables = tables_of(rows);
    return section;
}

// Jitter and loss only where a network has them.
Provenance provenance_of(const CompensatorStudyOptions& options, const std::string& command) {
    const auto any = [&options](double CompensatorNetwork::*value) {
        return std::any_of(options.networks.begin(), options.networks.end(),
                           [value](const CompensatorNetwork& network) { return network.*value > 0; });
    };
    Provenance provenance{{"command", command}, {"seed", std::to_string(options.seed)}};
    if (any(&CompensatorNetwork::jitter_spread_s))
        provenance.emplace_back("jitter",
                                fmt::format("uniform, +-{:g} ms, on the force path", 1000 * kJitter_s));
    if (any(&CompensatorNetwork::loss))
        provenance.emplace_back("loss", fmt::format("{:g} %, on each way", 100 * kLoss));
    provenance.emplace_back("version", kVersion);
    return provenance;
}

}  // namespace

std::vector<CompensatorNetwork> standard_networks() {
    std::vector<CompensatorNetwork> networks = plain_networks({0, 0.010, 0.025, kDelay_s, 0.100, 0.200});
    networks.push_back({"50 ms + jitter", kDelay_s, kJitter_s, 0});
    networks.push_back({"50 ms + jitter + loss", kDelay_s, kJitter_s, kLoss});
    return networks;
}

void write_compensator_report(const SystemSettings& settings, const CompensatorStudyOptions& options,
                              const std::vector<CompensatorTrial>& trials, const std::string& command,
                              const Provenance& made_with, const std::filesystem::path& out) {
    const std::vector<CompensatorRow> rows = condense(settings, options, trials);
    const std::vector<std::string> findings = compensator_findings(rows, trials);
    write_text_file(out / "compensators.csv", compensator_rows_csv(rows));
    nlohmann::ordered_json json{{"command", command},
                                {"version", kVersion},
                                {"seed", options.seed},
                                {"subjects", options.subjects},
                                {"trials", options.trials}};
    json["findings"] = findings;
    json["rows"] = compensator_rows_json(rows);
    write_text_file(out / "compensators.json", json_text(json, 2) + '\n');
    ReportInput report;
    report.title = "Thimble: delay compensators";
    report.sections.push_back(comparison_section(rows, findings, options, out));
    report.sections.push_back(handle_loop_section(out, options.jobs));
    report.sections.push_back(perceptual_loop_section(settings, out));
    report.provenance = provenance_of(options, command);
    report.provenance.insert(report.provenance.end(), made_with.begin(), made_with.end());
    say_virtual_subjects(report);
    write_report(report, out / "report.html");
    write_summary(report, out / "summary.json");
}

}  // namespace thimble
