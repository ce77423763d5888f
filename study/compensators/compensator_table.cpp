#include "study/compensators/compensator_table.hpp"

#include <array>
#include <iterator>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "common/csv/csv.hpp"
#include "common/error.hpp"

namespace thimble {
namespace {

// Columns that are planned; the others are measured.
constexpr std::array kPlanned{"condition", "network", "delay_s", "jitter_spread_s",
                              "loss",      "subject", "trial",   "hand_share"};

std::vector<std::string_view> compensator_columns() {
    std::vector<std::string_view> columns(kPlanned.begin(), kPlanned.end());
    columns.insert(columns.end(), {"completed", "oscillates"});
    for (const CompensatorValue& value : kCompensatorValues) columns.push_back(value.column);
    return columns;
}

// The columns of compensators.csv behind condition and network.
std::vector<std::pair<const char*, double>> cells_of(const CompensatorRow& row) {
    std::vector<std::pair<const char*, double>> cells{
        {"delay_s", row.network.delay_s}, {"jitter_spread_s", row.network.jitter_spread_s},
        {"loss", row.network.loss},       {"trials", row.trials},
        {"completed", row.completed},     {"oscillating", row.oscillating}};
    for (const CompensatorValue& value : kCompensatorValues)
        cells.emplace_back(value.column, row.*value.of_row);
    cells.emplace_back("hand_share", row.share);
    return cells;
}

std::string identity_of(const CompensatorTrial& trial, const std::string& name) {
    std::string text = fmt::format("{},{},{},{},{},{},{},", name, trial.network.name, trial.network.delay_s,
                                   trial.network.jitter_spread_s, trial.network.loss,
                                   trial.conditions.subject, trial.conditions.trial);
    write_number(std::back_inserter(text), trial.share);
    return text;
}

std::string identity_of(const CsvReader& line) {
    std::string text(line.field(0).text);
    for (std::size_t i = 1; i < kPlanned.size(); ++i) text.append(",").append(line.field(i).text);
    return text;
}

void read_outcome(const CsvReader& line, CompensatorTrial& trial) {
    std::size_t at = kPlanned.size();
    trial.completed = line.field(at++).flag();
    trial.metrics.oscillates = line.field(at++).flag();
    for (const CompensatorValue& value : kCompensatorValues) value.of(trial) = line.field(at++).number();
}

// How many lines are there; what a program that was killed left of its last one is cut off once the others are read.
std::size_t recover(const std::filesystem::path& path, const std::vector<std::string>& names,
                    std::vector<CompensatorTrial>& plan) {
    std::error_code none;
    if (!std::filesystem::exists(path, none)) return 0;
    const std::vector<std::string_view> columns = compensator_columns();
    CsvReader reader(path, columns, ',', 0, LastLine::kMayBeTorn);
    std::size_t done = 0;
    for (; reader.next(); ++done) {
        if (done >= plan.size() ||
            identity_of(reader) != identity_of(plan[done], names[plan[done].condition]))
            throw Error(
                ExitCode::kUsage,
                fmt::format("{}:{}: this trial belongs to a comparison with other settings: repeat these "
                            "settings, replace it with --overwrite, or name another folder with --out",
                            path.string(), done + 2));
        read_outcome(reader, plan[done]);
    }
    keep_lines(path, done);
    return done;
}

}  // namespace

CompensatorTrialTable::CompensatorTrialTable(const std::filesystem::path& path,
                                             const std::vector<CompensatorCondition>& conditions,
                                             std::vector<CompensatorTrial>& plan)
    : names_(names_of(conditions)), done_(recover(path, names_, plan)), file_(path, IfExists::kContinue) {
    if (!file_.is_new()) return;
    file_.write(fmt::format("{}\n", fmt::join(compensator_columns(), ",")));
    file_.sync();
}

void CompensatorTrialTable::append(const CompensatorTrial& trial) {
    std::string line = fmt::format("{},{},{}", identity_of(trial, names_[trial.condition]),
                                   trial.completed ? 1 : 0, trial.metrics.oscillates ? 1 : 0);
    for (const CompensatorValue& value : kCompensatorValues) {
        line += ',';
        write_number(std::back_inserter(line), value.of(trial));
    }
    file_.write(line + '\n');
    file_.sync();
}

std::string compensator_rows_csv(const std::vector<CompensatorRow>& rows) {
    std::string text = "condition,network";
    for (const auto& [column, value] : cells_of({})) text.append(",").append(column);
    text += '\n';
    for (const CompensatorRow& row : rows) {
        text += row.name + ',' + row.network.name;
        for (const auto& [column, value] : cells_of(row)) {
            text += ',';
            write_number(std::back_inserter(text), value);
        }
        text += '\n';
    }
    return text;
}

nlohmann::ordered_json compensator_rows_json(const std::vector<CompensatorRow>& rows) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const CompensatorRow& row : rows) {
        nlohmann::ordered_json object{{"condition", row.name}, {"network", row.network.name}};
        for (const auto& [column, value] : cells_of(row)) object[column] = value;  // NaN becomes null
        list.push_back(object);
    }
    return list;
}

}  // namespace thimble
