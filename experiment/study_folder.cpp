#include "experiment/study_folder.hpp"

#include <limits>

#include <fmt/format.h>

#include "common/error.hpp"
#include "experiment/condition_summary.hpp"

namespace thimble {
namespace {

constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max() - 1;

bool same(const TrialConditions& a, const TrialConditions& b) {
    return a.study_seed == b.study_seed && a.experiment == b.experiment && a.subject == b.subject &&
           a.trial == b.trial && a.modality == b.modality && same_delay(a.delay_s, b.delay_s) &&
           a.fixture_position_m == b.fixture_position_m && a.removes_fixture == b.removes_fixture &&
           a.remedy == b.remedy;
}

void check_plan(const std::filesystem::path& table, const std::vector<TrialRow>& rows,
                const std::vector<TrialConditions>& planned) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (i < planned.size() && same(rows[i].conditions, planned[i])) continue;
        throw Error(ExitCode::kUsage,
                    fmt::format("{}:{}: this trial is not the one this study would have run there: --resume "
                                "needs the same experiment, seed, subjects, order and session file",
                                table.string(), i + 2));
    }
}

bool is_there(const std::filesystem::path& file) {
    std::error_code ignored;
    return std::filesystem::exists(file, ignored);
}

// Without power the curves, which are not forced to the disk, can be behind the table: what has no curve is
// run again.
std::vector<TrialRow> recover(const std::filesystem::path& table, const std::filesystem::path& curves,
                              const TakeCurve& take_curve) {
    keep_lines(table, kAll);
    std::vector<TrialRow> rows;
    if (is_there(table) && std::filesystem::file_size(table) > 0) rows = read_trial_table(table);
    keep_lines(curves, rows.size());
    std::size_t both = 0;
    if (is_there(curves) && std::filesystem::file_size(curves) > 0) {
        read_curves(curves, [&](const TrialCurve& curve) {
            take_curve(curve);
            ++both;
        });
    }
    keep_lines(table, both);
    rows.resize(both);
    return rows;
}

}  // namespace

StudyTables::StudyTables(const std::filesystem::path& folder, const std::string& name, IfExists if_exists,
                         const std::vector<TrialConditions>& planned, const TakeCurve& take_curve)
    : earlier_(if_exists == IfExists::kContinue
                   ? recover(folder / (name + ".csv"), folder / (name + "_curves.csv"), take_curve)
                   : std::vector<TrialRow>{}),
      table_(folder / (name + ".csv"), if_exists),
      curves_(folder / (name + "_curves.csv"), if_exists) {
    check_plan(folder / (name + ".csv"), earlier_, planned);
}

void StudyTables::append(const TrialRow& row, const TrialCurve& curve) {
    curves_.append(curve);
    table_.append(row);
}

}  // namespace thimble
