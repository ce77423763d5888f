#include "study/compensators/compensator_table.hpp"

#include <array>
#include <cmath>
#include <iterator>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "common/csv/csv.hpp"
#include "common/error.hpp"

namespace thimble {
namespace {

constexpr std::array<std::string_view, 16> kTrialColumns{"condition",
                                                         "network",
                                                         "delay_s",
                                                         "jitter_spread_s",
                                                         "loss",
                                                         "subject",
                                                         "trial",
                                                         "hand_share",
                                                         "completed",
                                                         "oscillates",
                                                         "oscillation_peak_to_peak_m",
                                                         "penetration_mean_m",
                                                         "penetration_max_m",
                                                         "completion_time_s",
                                                         "rendered_stiffness",
                                                         "drift_needle_m"};
constexpr std::size_t kIdentity = 8;  // columns that are planned, not measured

struct RowColumn {
    std::string_view name;
    double (*value)(const CompensatorRow&);
};
constexpr std::array kRowColumns{
    RowColumn{"delay_s", [](const CompensatorRow& r) { return r.network.delay_s; }},
    RowColumn{"jitter_spread_s", [](const CompensatorRow& r) { return r.network.jitter_spread_s; }},
    RowColumn{"loss", [](const CompensatorRow& r) { return r.network.loss; }},
    RowColumn{"trials", [](const CompensatorRow& r) { return static_cast<double>(r.trials); }},
    RowColumn{"completed", [](const CompensatorRow& r) { return static_cast<double>(r.completed); }},
    RowColumn{"oscillating", [](const CompensatorRow& r) { return static_cast<double>(r.oscillating); }},
    RowColumn{"oscillation_peak_to_peak_m",
              [](const CompensatorRow& r) { return r.oscillation_peak_to_peak_m; }},
    RowColumn{"penetration_mean_m", [](const CompensatorRow& r) { return r.penetration_mean_m; }},
    RowColumn{"penetration_max_m", [](const CompensatorRow& r) { return r.penetration_max_m; }},
    RowColumn{"completion_time_s", [](const CompensatorRow& r) { return r.completion_time_s; }},
    RowColumn{"rendered_stiffness", [](const CompensatorRow& r) { return r.rendered_stiffness; }},
    RowColumn{"drift_needle_m", [](const CompensatorRow& r) { return r.drift_needle_m; }},
    RowColumn{"hand_share", [](const CompensatorRow& r) { return r.share; }}};

std::string identity_of(const CompensatorTrial& trial, const std::string& name) {
    return fmt::format("{},{},{},{},{},{},{},{}", name, trial.network.name, trial.network.delay_s,
                       trial.network.jitter_spread_s, trial.network.loss, trial.conditions.subject,
                       trial.conditions.trial, trial.share);
}

std::string identity_of(const CsvReader& line) {
    std::string text(line.field(0).text);
    for (std::size_t i = 1; i < kIdentity; ++i) text.append(",").append(line.field(i).text);
    return text;
}

void read_outcome(const CsvReader& line, CompensatorTrial& trial) {
    trial.completed = line.field(8).flag();
    trial.metrics.oscillates = line.field(9).flag();
    trial.metrics.oscillation_peak_to_peak_m = line.field(10).number();
    trial.metrics.penetration_mean_m = line.field(11).number();
    trial.metrics.penetration_max_m = line.field(12).number();
    trial.metrics.completion_time_s = line.field(13).number();
    trial.rendered_stiffness = line.field(14).number();
    trial.drift_needle_m = line.field(15).number();
}

std::vector<std::string> names_of(const std::vector<CompensatorCondition>& conditions) {
    std::vector<std::string> names;
    names.reserve(conditions.size());
    for (const CompensatorCondition& condition : conditions) names.push_back(condition.name);
    return names;
}

// How many lines are there; what a program that was killed left of its last one is cut off once the others are read.
std::size_t recover(const std::filesystem::path& path, IfExists if_exists,
                    const std::vector<std::string>& names, std::vector<CompensatorTrial>& plan) {
    std::error_code none;
    if (if_exists != IfExists::kContinue || !std::filesystem::exists(path, none)) return 0;
    CsvReader reader(path, kTrialColumns, ',', 0, LastLine::kMayBeTorn);
    std::size_t done = 0;
    for (; reader.next(); ++done) {
        if (done >= plan.size() ||
            identity_of(reader) != identity_of(plan[done], names[plan[done].condition]))
            throw Error(ExitCode::kUsage,
                        fmt::format("{}:{}: this trial is not the one this comparison would have run there: "
                                    "choose another folder, or say --overwrite",
                                    path.string(), done + 2));
        read_outcome(reader, plan[done]);
    }
    keep_lines(path, done);
    return done;
}

}  // namespace

CompensatorTrialTable::CompensatorTrialTable(const std::filesystem::path& path, IfExists if_exists,
                                             const std::vector<CompensatorCondition>& conditions,
                                             std::vector<CompensatorTrial>& plan)
    : names_(names_of(conditions)), done_(recover(path, if_exists, names_, plan)), file_(path, if_exists) {
    if (!file_.is_new()) return;
    file_.write(fmt::format("{}\n", fmt::join(kTrialColumns, ",")));
    file_.sync();
}

void CompensatorTrialTable::append(const CompensatorTrial& trial) {
    std::string line = fmt::format("{},{},{}", identity_of(trial, names_[trial.condition]),
                                   trial.completed ? 1 : 0, trial.metrics.oscillates ? 1 : 0);
    for (const double value : {trial.metrics.oscillation_peak_to_peak_m, trial.metrics.penetration_mean_m,
                               trial.metrics.penetration_max_m, trial.metrics.completion_time_s,
                               trial.rendered_stiffness, trial.drift_needle_m}) {
        line += ',';
        write_number(std::back_inserter(line), value);
    }
    file_.write(line + '\n');
    file_.sync();
}

std::string compensator_rows_csv(const std::vector<CompensatorRow>& rows) {
    std::string text = "condition,network";
    for (const RowColumn& column : kRowColumns) text.append(",").append(column.name);
    text += '\n';
    for (const CompensatorRow& row : rows) {
        text += row.name + ',' + row.network.name;
        for (const RowColumn& column : kRowColumns) {
            text += ',';
            write_number(std::back_inserter(text), column.value(row));
        }
        text += '\n';
    }
    return text;
}

nlohmann::ordered_json compensator_rows_json(const std::vector<CompensatorRow>& rows) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const CompensatorRow& row : rows) {
        nlohmann::ordered_json object{{"condition", row.name}, {"network", row.network.name}};
        for (const RowColumn& column : kRowColumns) {
            const double value = column.value(row);
            object[std::string(column.name)] = std::isfinite(value) ? nlohmann::ordered_json(value) : nullptr;
        }
        list.push_back(object);
    }
    return list;
}

}  // namespace thimble
