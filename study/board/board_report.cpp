#include "study/board/board_report.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "analysis/figures/heat_map.hpp"
#include "common/json_text.hpp"
#include "common/text_file.hpp"
#include "common/version.hpp"

namespace thimble {
namespace {

std::string shown(double value, int decimals) {
    return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : std::string(kDash);
}

std::string with_interval(const BoardValue& value, double factor, int decimals) {
    if (!std::isfinite(value.mean)) return std::string(kDash);
    return fmt::format("{:.{}f} ({:.{}f} to {:.{}f})", factor * value.mean, decimals, factor * value.low,
                       decimals, factor * value.high, decimals);
}

std::string row_file(const BoardRow& row) {
    return fmt::format("{}_{}_{}.toml", row.controller, row.codec, row.condition);
}

ReportTable front_table(std::vector<Contestant> contestants) {
    ReportTable table{
        "Fronts",
        "Contestant: a controller with a codec. Front 1: no other contestant dominates it. A contestant "
        "dominates another if it is better in one objective and worse in none. A difference counts if it is "
        "outside the 90 % intervals and not smaller than 1 % of trials, 0.1 mm, 2 % of the stiffness or 20 "
        "packets/s. Unstable trials: in each condition, the larger of two shares: trials that oscillated, "
        "and trials that were not completed.",
        {"contestant", "front", "stable conditions", "unstable trials, %", "maximum penetration, mm",
         "stiffness felt", "drift, mm", "packets/s", "dominated by"}};
    std::stable_sort(contestants.begin(), contestants.end(), [](const Contestant& a, const Contestant& b) {
        return a.front - 1 < b.front - 1;  // 0, not ranked, comes last
    });
    table.rows.reserve(contestants.size());
    for (const Contestant& one : contestants)
        table.rows.push_back(
            {one.name, one.front > 0 ? std::to_string(one.front) : std::string(kDash),
             fmt::format("{} of {}", one.stable_rows, one.rows), with_interval(one.values[kUnstable], 100, 1),
             with_interval(one.values[kDepth], 1000, 2), with_interval(one.values[kFelt], 1, 3),
             with_interval(one.values[kAway], 1000, 2), with_interval(one.values[kSent], 1, 0),
             one.dominated_by.empty() ? std::string(kDash)
                                      : fmt::format("{}", fmt::join(one.dominated_by, ", "))});
    return table;
}

std::string reason(const BoardRow& row) {
    if (row.status != "ok") return row.status;
    const auto count = [&row](BoardMeasure measure) {
        return std::lround(row.trials * row.values[measure].mean);
    };
    std::string text;
    if (count(kOscillating) > 0) text = fmt::format("{} of {} oscillate", count(kOscillating), row.trials);
    if (count(kNotCompleted) > 0)
        text += fmt::format("{}{} of {} are not completed", text.empty() ? "" : ", ", count(kNotCompleted),
                            row.trials);
    return text;
}

ReportTable failing_table(const std::vector<BoardRow>& rows) {
    ReportTable table{"Failed rows, each with a trial to look at",
                      "Run the command in this folder to repeat the first failed trial. thimble play "
                      "--replay seen then shows it.",
                      {"controller", "codec", "condition", "reason", "command"}};
    for (const BoardRow& row : rows) {
        if (row.stable() || !row.possible()) continue;
        const std::string command =
            row.subject > 0 ? fmt::format("thimble run sessions/{} --clock virtual --out seen", row_file(row))
                            : std::string(kDash);
        table.rows.push_back({row.controller, row.codec, row.condition, reason(row), command});
    }
    return table;
}

ReportTable cost_table(const std::vector<BoardCost>& costs) {
    ReportTable table{"Computing time for a millisecond of the session, us",
                      "Wall-clock time on this machine, in the fastest of three trials. It differs from run "
                      "to run, so only board_cost.csv has it. HF is the session without a controller.",
                      {"controller", "codec", "median", "999 in 1000", "worst"}};
    table.rows.reserve(costs.size());
    for (const BoardCost& cost : costs)
        table.rows.push_back({cost.controller, cost.codec, shown(cost.median_us, 1), shown(cost.most_us, 1),
                              shown(cost.worst_us, 1)});
    return table;
}

ReportTable measure_table(const std::vector<BoardRow>& rows) {
    ReportTable table{
        "All rows",
        "Means over trials. board.csv has the 90 % intervals: Wilson intervals for shares, bootstrap "
        "percentiles for the rest.",
        {"controller", "codec", "condition", "oscillating, %", "not completed, %", "penetration, mm",
         "maximum, mm", "time, s", "stiffness felt", "drift, mm", "energy out, mJ", "packets/s", "kB/s"}};
    table.rows.reserve(rows.size());
    for (const BoardRow& row : rows) {
        const auto cell = [&row](BoardMeasure measure, double factor, int decimals) {
            return shown(factor * row.values[measure].mean, decimals);
        };
        table.rows.push_back({row.controller, row.codec, row.condition, cell(kOscillating, 100, 0),
                              cell(kNotCompleted, 100, 0), cell(kPenetrationMean, 1000, 2),
                              cell(kPenetrationMax, 1000, 2), cell(kCompletionTime, 1, 1),
                              cell(kStiffnessFelt, 1, 3), cell(kDrift, 1000, 2), cell(kEnergyOut, 1000, 1),
                              cell(kPackets, 1, 0), cell(kBytes, 1e-3, 1)});
    }
    return table;
}

template <class Names>
std::size_t place_in(Names& names, const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    names.push_back(name);
    return names.size() - 1;
}

// One for the paper's task over each network, one for other hands, tissues and scenes.
FigureSource stability_figure(const std::vector<BoardRow>& rows, const std::vector<Contestant>& contestants,
                              bool papers_task) {
    HeatMap map{
        {},         {}, {}, "", "trials that oscillated or that did not complete", "maximum penetration (mm)",
        kVermillion};
    const bool codecs = !contestants.empty() && contestants.front().name.find(" / ") != std::string::npos;
    for (const BoardRow& row : rows) {
        const bool papers = row.hands == "virtual" && row.tissue == "soft" && row.scene == "paper";
        if (papers != papers_task) continue;
        std::string column = row.condition;
        std::replace(column.begin(), column.end(), '+', '\n');
        const std::size_t x = place_in(map.columns, column);
        const std::size_t y =
            place_in(map.rows, codecs ? row.controller + " / " + row.codec : row.controller);
        const bool ok = row.status == "ok";
        const double bad = std::max(row.values[kOscillating].mean, row.values[kNotCompleted].mean);
        map.cells.push_back({x, y, ok ? 100 * bad : 100,
                             ok ? shown(1000 * row.values[kPenetrationMax].mean, 1) : std::string("!")});
    }
    if (map.cells.empty()) return {};
    FigureSource figure = heat_map_figure(map, papers_task ? "board_networks" : "board_tasks");
    figure.title = papers_task ? "Stability over each network" : "Other hands, tissues and scenes";
    figure.caption =
        "In each cell: maximum penetration in mm. Darker: a larger share of trials "
        "that oscillated, or that were not completed. !: no measures.";
    return figure;
}

// JSON has no NaN: null stands for it.
nlohmann::ordered_json json_of(const BoardValue& value) {
    return {{"mean", value.mean}, {"interval", {value.low, value.high}}};
}

nlohmann::ordered_json contestants_json(const std::vector<Contestant>& contestants) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Contestant& one : contestants) {
        nlohmann::ordered_json object{{"name", one.name},
                                      {"front", one.front > 0 ? nlohmann::ordered_json(one.front) : nullptr},
                                      {"dominated_by", one.dominated_by},
                                      {"rows", one.rows},
                                      {"stable_rows", one.stable_rows},
                                      {"failed_rows", one.failed_rows}};
        for (std::size_t i = 0; i < kObjectives; ++i)
            object[kObjectiveRules[i].name] = json_of(one.values[i]);
        list.push_back(object);
    }
    return list;
}

// Other files in that folder are the user's.
void remove_sessions(const std::vector<BoardRow>& rows, const std::filesystem::path& folder) {
    std::error_code no_matter;
    if (!std::filesystem::is_directory(std::filesystem::symlink_status(folder, no_matter))) return;
    for (const BoardRow& row : rows) remove_file(folder / row_file(row));
    std::filesystem::remove(folder, no_matter);  // unless it holds others
}

void write_sessions(const BoardPlan& plan, const std::vector<BoardRow>& rows,
                    const std::filesystem::path& out) {
    remove_sessions(rows, out / "sessions");
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (rows[i].subject == 0) continue;
        make_folder(out / "sessions");
        write_text_file(out / "sessions" / row_file(rows[i]),
                        row_session(plan, place_of(plan, i), rows[i].subject));
    }
}

std::string summary_of(const std::vector<Contestant>& contestants) {
    std::vector<std::string> first, everywhere;
    for (const Contestant& one : contestants) {
        if (one.front == 1) first.push_back(one.name);
        if (one.stable_rows == one.rows) everywhere.push_back(one.name);
    }
    const auto listed = [](const std::vector<std::string>& names) {
        return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
    };
    return fmt::format("Not dominated (front 1): {}. Stable in all conditions: {}.", listed(first),
                       listed(everywhere));
}

}  // namespace

void write_board_report(const BoardPlan& plan, const std::vector<BoardRow>& rows, const std::string& command,
                        const Provenance& made_with, const std::filesystem::path& out) {
    const std::vector<Contestant> contestants = rank_contestants(rows);
    write_sessions(plan, rows, out);
    ReportSection section;
    section.title = "Controllers and codecs";
    section.text = fmt::format(
        "{} controllers, {} codecs and {} conditions, with {} trials by virtual subjects in each row. "
        "Subjects and fixtures are the same in all rows.",
        plan.controllers.size(), plan.codecs.size(), plan.conditions.size(), plan.trials);
    section.findings = {summary_of(contestants)};
    section.drawn = draw_figures({pareto_figure(contestants), stability_figure(rows, contestants, true),
                                  stability_figure(rows, contestants, false)},
                                 out);
    const std::vector<BoardCost> costs = measure_costs(plan);
    write_text_file(out / "board_cost.csv", cost_csv(costs));
    section.tables = {front_table(contestants), failing_table(rows), cost_table(costs), measure_table(rows)};
    ReportInput report;
    report.title = "Thimble: controllers and codecs compared";
    report.sections.push_back(std::move(section));
    report.provenance = {{"command", command},
                         {"board", std::to_string(plan.version)},
                         {"seed", std::to_string(plan.seed)},
                         {"version", kVersion}};
    report.provenance.insert(report.provenance.end(), made_with.begin(), made_with.end());
    report.provenance.emplace_back("contestants and conditions", plan_text(plan));
    say_virtual_subjects(report);
    write_report(report, out / "board.html");
    nlohmann::ordered_json json{{"command", command},
                                {"version", kVersion},
                                {"board", plan.version},
                                {"seed", plan.seed},
                                {"trials", plan.trials}};
    json["contestants"] = contestants_json(contestants);
    write_text_file(out / "board.json", json_text(json, 2) + '\n');
}

}  // namespace thimble
