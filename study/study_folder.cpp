#include "study/study_folder.hpp"

#include <optional>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "common/control/control_settings.hpp"
#include "common/csv/csv_file.hpp"
#include "common/error.hpp"
#include "common/text_file.hpp"
#include "session/records/condition_summary.hpp"
#include "session/records/trajectory_file.hpp"

namespace thimble {
namespace {

// As far as a curve says it.
bool same_trial(const TrialConditions& a, const TrialConditions& b) {
    return a.experiment == b.experiment && a.subject == b.subject && a.trial == b.trial &&
           a.modality == b.modality && same_delay(a.delay_s, b.delay_s);
}

bool same(const TrialConditions& a, const TrialConditions& b) {
    return same_trial(a, b) && a.study_seed == b.study_seed && a.fixture_position_m == b.fixture_position_m &&
           a.removes_fixture == b.removes_fixture && a.compensator == b.compensator;
}

void check_plan(const std::filesystem::path& table, const std::vector<TrialRow>& rows,
                const std::vector<TrialConditions>& planned) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (i < planned.size() && same(rows[i].conditions, planned[i])) continue;
        throw Error(ExitCode::kUsage,
                    fmt::format("{}:{}: this trial belongs to a study with other settings: --resume needs "
                                "the same experiment, seed, subjects, order and session file",
                                table.string(), i + 2));
    }
}

bool is_there(const std::filesystem::path& file) {
    std::error_code ignored;
    return std::filesystem::exists(file, ignored);
}

// The names of its columns have the unit of their axis, s or %.
void refuse_other_axis(const std::filesystem::path& curves, const CurveGrid& grid) {
    const std::string header = first_line(curves);
    const bool whole = header.find("surface") != std::string::npos;
    const bool percent = header.find('%') != std::string::npos;
    if (!whole || percent == (grid.axis == CurveAxis::kEntryToBeep)) return;
    throw Error(ExitCode::kUsage,
                "{}: its curves have --axis {}: --resume needs the same --axis; or replace the study with "
                "--overwrite, or name another folder with --out",
                curves.string(), kCurveAxisNames[percent ? 1 : 0]);
}

// How many of the rows have their curve. Each of those curves goes to `take_curve`.
std::size_t take_curves(const std::filesystem::path& curves, const std::vector<TrialRow>& rows,
                        const TakeCurve& take_curve, const CurveGrid& grid) {
    if (!is_there(curves)) return 0;
    refuse_other_axis(curves, grid);
    std::size_t both = 0;
    const auto take = [&](const TrialCurve& curve) {
        if (both == rows.size()) return;  // its row was never written
        if (!same_trial(rows[both].conditions, curve.conditions))
            throw Error(ExitCode::kData,
                        fmt::format("{}:{}: this curve does not belong to the trial in the same line of the "
                                    "table; nothing was changed: name another folder with --out",
                                    curves.string(), both + 2));
        take_curve(curve);
        ++both;
    };
    read_curves(curves, take, LastLine::kMayBeTorn, grid);
    return both;
}

// All files are read and judged before one is cut. The curves are not forced to the disk: after a power cut they can be
// behind the table. A trial without its curve is run again, unless no trial has one: then the table is no study's.
std::vector<TrialRow> recover(const std::filesystem::path& table, const std::filesystem::path& curves,
                              const std::vector<TrialConditions>& planned, const TakeCurve& take_curve,
                              const CurveGrid& grid) {
    std::optional<CsvFile> held;  // an Error if another program writes it: its newer rows would be cut
    if (is_there(table)) held.emplace(table, IfExists::kContinue);
    std::vector<TrialRow> rows;
    if (held) rows = read_unfinished_trial_table(table);
    check_plan(table, rows, planned);
    const std::size_t both = take_curves(curves, rows, take_curve, grid);
    if (both == 0 && !rows.empty())
        throw Error(ExitCode::kData,
                    fmt::format("{}: has {} trials, but {} has no curves for them. thimble study writes "
                                "both; thimble run and thimble play write no curves. Nothing was changed: "
                                "name another folder with --out, or put the curves back",
                                table.string(), rows.size(), curves.string()));
    keep_lines(curves, both);
    keep_lines(table, both);
    rows.resize(both);
    return rows;
}

}  // namespace

StudyTables::StudyTables(const std::filesystem::path& folder, const std::string& name, IfExists if_exists,
                         const std::vector<TrialConditions>& planned, const TakeCurve& take_curve,
                         const CurveGrid& grid)
    : earlier_(
          if_exists == IfExists::kContinue
              ? recover(folder / (name + ".csv"), folder / (name + "_curves.csv"), planned, take_curve, grid)
              : std::vector<TrialRow>{}),
      table_(folder / (name + ".csv"), if_exists),
      curves_(folder / (name + "_curves.csv"), if_exists, grid) {}

void StudyTables::append(const TrialRow& row, const TrialCurve& curve) {
    curves_.append(curve);
    table_.append(row);
}

namespace {

// A figure is known by its script. Other files of the folder are the user's.
void remove_figures(const std::filesystem::path& folder) {
    std::error_code absent;
    if (!std::filesystem::is_directory(std::filesystem::symlink_status(folder, absent))) return;
    std::vector<std::filesystem::path> scripts;
    for (const auto& file : std::filesystem::directory_iterator(folder, absent))
        if (file.path().extension() == ".gp") scripts.push_back(file.path());
    for (std::filesystem::path& figure : scripts)
        for (const char* end : {".tsv", ".svg", ".pdf", ".gp"}) remove_file(figure.replace_extension(end));
}

}  // namespace

void remove_earlier_results(const std::filesystem::path& folder) {
    for (const char* name :
         {"trials.txt", "virtual.csv", "trials_curves.csv", "control.csv", "control_curves.csv", "no_lag.csv",
          "no_lag_curves.csv", "subjects.csv", "findings.json", "compensators.json", "claims.json",
          "summary.json", "report.html"})
        remove_file(folder / name);
    for (const std::string_view compensator : kCompensatorNames) {
        for (const char* end : {".csv", "_curves.csv"})
            remove_file(folder / fmt::format("hf_{}{}", compensator, end));
    }
    remove_trajectories(folder / "trajectories");
    remove_figures(folder / "figures");
}

}  // namespace thimble
