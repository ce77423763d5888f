#include "experiment/study_folder.hpp"

#include <algorithm>
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
           a.fixture_position_m == b.fixture_position_m && a.removes_fixture == b.removes_fixture;
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

}  // namespace

// Without power the curves, which are not forced to the disk, can be behind the table: what has no curve is
// run again.
StudyTables::Earlier StudyTables::recover(const std::filesystem::path& table,
                                          const std::filesystem::path& curves) {
    Earlier earlier;
    keep_lines(table, kAll);
    keep_lines(curves, kAll);
    if (is_there(table) && std::filesystem::file_size(table) > 0) earlier.rows = read_trial_table(table);
    if (is_there(curves) && std::filesystem::file_size(curves) > 0) earlier.curves = read_curves(curves);
    const std::size_t both = std::min(earlier.rows.size(), earlier.curves.size());
    keep_lines(table, both);
    keep_lines(curves, both);
    earlier.rows.resize(both);
    earlier.curves.resize(both);
    return earlier;
}

StudyTables::StudyTables(const std::filesystem::path& folder, const std::string& name, IfExists if_exists,
                         const std::vector<TrialConditions>& planned)
    : earlier_(if_exists == IfExists::kContinue
                   ? recover(folder / (name + ".csv"), folder / (name + "_curves.csv"))
                   : Earlier{}),
      table_(folder / (name + ".csv"), if_exists),
      curves_(folder / (name + "_curves.csv"), if_exists) {
    check_plan(folder / (name + ".csv"), earlier_.rows, planned);
}

void StudyTables::append(const TrialRow& row, const TrialCurve& curve) {
    curves_.append(curve);
    table_.append(row);
}

}  // namespace thimble
