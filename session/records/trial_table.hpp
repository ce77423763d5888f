// The table of trials, one CSV line each: conditions, metrics, how it ended. SI units, named in the columns.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/csv/columns.hpp"
#include "common/csv/csv_file.hpp"
#include "session/records/metrics.hpp"
#include "session/records/trial_record.hpp"

namespace thimble {

struct TrialRow {
    TrialConditions conditions;
    TrialMetrics metrics;
    EndReason reason = EndReason::kNone;
    Role lost_peer = Role::kSession;  // meaningful with EndReason::kPeerLost, kDeviceFault and stops
    // Of the network, needle and force path together: the round trip without the slave's hold time. Medians.
    double delay_achieved_s = std::numeric_limits<double>::quiet_NaN();
    double round_trip_s = std::numeric_limits<double>::quiet_NaN();
};

TrialRow make_row(const TrialRecord& record);

// "completed", "timeout", "interrupted", "emergency_stop", "peer_lost_<role>", "device_fault_<role>",
// "safety_stop_<role>"; "none" for a trial that has not ended.
std::string outcome_text(EndReason reason, Role lost_peer);
// False if the text is none of these.
bool parse_outcome(std::string_view text, EndReason& reason, Role& lost_peer);

// A trial that came to its own end; only these say anything about the operator.
inline bool ran_to_its_end(const TrialRow& row) {
    return row.reason == EndReason::kCompleted || row.reason == EndReason::kTimeout;
}

// Those of one experiment, its control trials included.
std::vector<TrialRow> of_experiment(const std::vector<TrialRow>& rows, std::uint32_t experiment);
// Those that end as they began: the others cannot be pooled with them.
std::vector<TrialRow> without_removals(const std::vector<TrialRow>& rows);

// The columns of a row, also for tables that hold more than a row.
std::span<const TableColumn<TrialRow>> trial_columns();
// Columns at the end that an earlier version lacks. A table without them is readable.
inline constexpr std::size_t kLaterColumns = 1;

// Appends; each row is on the disk when append() returns, so that a crash costs the running trial only.
class TrialTable {
  public:
    // Throws Error: usage, if the file exists and may not be replaced; data, if a table to be continued is
    // damaged.
    explicit TrialTable(const std::filesystem::path& path, IfExists if_exists = IfExists::kRefuse);
    void append(const TrialRow& row);

  private:
    CsvFile file_;
};

// Throws Error (data) naming line and column of what cannot be read.
std::vector<TrialRow> read_trial_table(const std::filesystem::path& path);
// Of a table to be continued: its last line may be torn. Throws, too, if the table is of an earlier version.
std::vector<TrialRow> read_unfinished_trial_table(const std::filesystem::path& path);

}  // namespace thimble
