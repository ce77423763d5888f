#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/findings.hpp"
#include "analysis/tables/study_columns.hpp"
#include "analysis/text/html.hpp"
#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/text_file.hpp"
#include "common/version.hpp"
#include "study/power/power.hpp"

namespace thimble {
namespace {

constexpr std::string_view kAtOnce =
    "Intervals and tests hold at 95 % for the six pairs of a measure at once, which is 99.2 % for each pair.";

std::string needed_text(const std::optional<std::size_t>& subjects) {
    return subjects ? std::to_string(*subjects) : fmt::format("more than {}", kMostPowerSubjects);
}

std::string shown_difference(const PowerComparison& c) {
    return c.difference ? shown_text(*c.difference, c.metric) : std::string(kDash);
}

std::string goal_text(const PowerOptions& options) {
    if (!options.precision_m && !options.precision_s) return fmt::format("power {:g}", options.power);
    std::string widths;
    if (options.precision_m) widths += fmt::format("{:g} mm", 1e3 * *options.precision_m);
    if (options.precision_s)
        widths += fmt::format("{}{:g} s", widths.empty() ? "" : " and ", *options.precision_s);
    return fmt::format("intervals of +-{} at most, in {:g} of the studies", widths, options.power);
}

std::vector<Metric> judged_measures(const PowerOptions& options) {
    std::vector<Metric> metrics = measures_of(3);
    std::erase_if(metrics, [&](Metric metric) { return !options.judges(metric); });
    return metrics;
}

// The lines of a panel: shares over subjects, a block of data per pair.
std::string curves_of(const PowerResult& result, Metric metric, double delay_s, std::size_t& block,
                      FigureSource& figure) {
    std::string lines;
    for (const PowerComparison& c : result.comparisons) {
        if (c.metric != metric || !same_delay(c.delay_s, delay_s) || c.curve.empty()) continue;
        for (const auto& [subjects, power] : c.curve) {
            write_cell(figure.data, static_cast<double>(subjects));
            write_cell(figure.data, power);
            figure.data += '\n';
        }
        figure.data += "\n\n";
        lines += fmt::format("{}'{}.tsv' index {} with linespoints title '{} - {}'",
                             lines.empty() ? "" : ", ", figure.name, block++, c.first, c.second);
    }
    return lines;
}

// A panel per measure, a line per pair.
FigureSource power_figure(const PowerResult& result, const PowerOptions& options, double delay_s,
                          std::size_t number) {
    const bool precise = options.precision_m || options.precision_s;
    FigureSource figure;
    figure.name = fmt::format("power_{}", number);
    figure.title = fmt::format("{} at {}", precise ? "Narrow intervals" : "Power", delay_text(delay_s));
    figure.caption = fmt::format(
        "Share of simulated studies in which {}, by the number of virtual subjects.",
        precise ? "the interval of a pair is narrow enough" : "the difference of a pair is significant");
    const std::vector<Metric> metrics = judged_measures(options);
    figure.script = gnuplot_preamble(figure.name, 960, 340) +
                    fmt::format(
                        "set multiplot layout 1,{}\nset xlabel 'subjects'\nset ylabel '{}'\n"
                        "set yrange [0:1.02]\nset xrange [0:{}]\nset key bottom right\n",
                        metrics.size(), precise ? "share of studies" : "power", kMostPowerSubjects);
    std::size_t block = 0;
    for (const Metric metric : metrics) {
        const std::string lines = curves_of(result, metric, delay_s, block, figure);
        figure.script += fmt::format("set title '{}'\n", name_of(metric));
        if (!lines.empty()) figure.script += "plot " + lines + "\n";
    }
    figure.script += "unset multiplot\n";
    return figure;
}

nlohmann::ordered_json to_json(const PowerComparison& c, std::uint32_t trials) {
    nlohmann::ordered_json json{{"comparison", name_of(c)},
                                {"measure", info(c.metric).name},
                                {"first", c.first},
                                {"second", c.second},
                                {"delay_s", c.delay_s},
                                {"difference", or_null(c.difference)},
                                {"subjects_with_a_value", c.with_a_value},
                                {"subjects", or_null(c.subjects.at(trials))}};
    for (const auto& [count, subjects] : c.subjects)
        json["subjects_by_trials"][std::to_string(count)] = or_null(subjects);
    json["curve"] = c.curve;
    return json;
}

}  // namespace

std::vector<ReportTable> power_tables(const PowerResult& result, const PowerOptions& options) {
    std::vector<ReportTable> tables;
    for (const double delay_s : options.delays_s) {
        ReportTable table{
            fmt::format("Virtual subjects needed at {} for {}", delay_text(delay_s), goal_text(options)),
            fmt::format(
                "Last columns: subjects needed, by the number of trials of each subject and modality. With a "
                "value: how many of the {} simulated subjects have trials that give a difference. {}",
                options.pool, kAtOnce),
            {"comparison", "difference", "with a value"}};
        for (const PowerComparison& c : result.comparisons) {
            if (!same_delay(c.delay_s, delay_s)) continue;
            std::vector<std::string> row{fmt::format("{} - {}, {}", c.first, c.second, name_of(c.metric)),
                                         shown_difference(c), std::to_string(c.with_a_value)};
            for (auto it = c.subjects.rbegin(); it != c.subjects.rend(); ++it) {
                if (table.rows.empty()) table.columns.push_back(std::to_string(it->first));
                row.push_back(needed_text(it->second));
            }
            table.rows.push_back(std::move(row));
        }
        tables.push_back(std::move(table));
    }
    return tables;
}

nlohmann::ordered_json to_json(const PowerResult& result, const PowerOptions& options) {
    nlohmann::ordered_json json{{"power", options.power},
                                {"delays_s", options.delays_s},
                                {"virtual_subjects", options.pool},
                                {"trials", options.trials},
                                {"seed", options.seed}};
    if (options.precision_m) json["precision_m"] = *options.precision_m;
    if (options.precision_s) json["precision_s"] = *options.precision_s;
    json["comparisons"] = nlohmann::ordered_json::array();
    for (const PowerComparison& c : result.comparisons)
        json["comparisons"].push_back(to_json(c, options.trials));
    return json;
}

void refuse_other_report(const std::filesystem::path& out) {
    for (const char* name : {"power.json", "report.html"})
        if (std::filesystem::exists(out / name))
            throw Error(ExitCode::kUsage,
                        "{}: exists already: replace it with --overwrite, or name another folder with --out",
                        (out / name).string());
}

void refuse_other_report(const std::filesystem::path& table, IfExists if_exists) {
    if (if_exists == IfExists::kReplace || std::filesystem::exists(table)) return;
    refuse_other_report(table.parent_path());
}

void write_power_report(const PowerResult& result, const PowerOptions& options, const std::string& command,
                        const Provenance& made_with, const std::filesystem::path& out) {
    make_folder(out);
    write_text_file(out / "power.json", json_text(to_json(result, options), 2) + "\n");
    std::vector<FigureSource> figures;
    for (std::size_t i = 0; i < options.delays_s.size(); ++i)
        figures.push_back(power_figure(result, options, options.delays_s[i], i + 1));
    ReportSection section;
    section.title = "Virtual subjects needed";
    section.text = fmt::format(
        "Studies are drawn at random from {} virtual subjects. Each is tested as the results of a study are: "
        "signed-rank test, all pairs of a measure at once. A subject without a value is left out of its "
        "study.",
        options.pool);
    section.drawn = draw_figures(std::move(figures), out);
    section.tables = power_tables(result, options);
    ReportInput report{"Thimble: how many subjects a study needs", {section}, {}};
    report.provenance = {{"command", command}, {"seed", std::to_string(options.seed)}, {"version", kVersion}};
    report.provenance.insert(report.provenance.end(), made_with.begin(), made_with.end());
    say_virtual_subjects(report);
    write_report(report, out / "report.html");
}

}  // namespace thimble
