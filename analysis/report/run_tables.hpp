// Tables of how well the machine kept time during a real-time run.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "analysis/text/html.hpp"
#include "common/histogram.hpp"
#include "common/network_settings.hpp"
#include "session/clocks/clock_summary.hpp"
#include "session/launch/node_starter.hpp"
#include "session/records/trial_table.hpp"

namespace thimble {

struct NodeReport {
    double delay_s = 0;
    nlohmann::ordered_json report;  // as the node wrote it
};

// Deadlines and lateness per node and condition.
ReportTable deadline_table(const std::vector<NodeReport>& reports);
// Every refusal counter that is not zero, per node and condition.
ReportTable refusal_table(const std::vector<NodeReport>& reports);
// Refusals by the protection and agreements of keys, per program and condition. Mode "none" gives no row.
ReportTable security_table(const std::vector<NodeReport>& reports);
// In which trials an input fell silent and its stale policy acted, and how long.
ReportTable stale_table(const std::vector<NodeReport>& reports);
// Which node ran on which machine.
ReportTable machine_table(const NodeStarter& starter, const NetworkSettings& network);
// Handle to handle through all processes at 0 ms against a bare ping-pong times the number of hops.
ReportTable round_trip_table(const std::vector<TrialRow>& rows, const Histogram& bare);

// The clock of each node against the session's.
ReportTable clock_table(const std::vector<NodeClock>& clocks);

// "12.3", or "not known: +-40.1", in microseconds.
std::string one_way_text_us(const std::optional<OneWayDelay>& delay);
// "-0.12 to 3.40" in parts per million.
std::string rate_text_ppm(const ClockSummary& clock);

}  // namespace thimble
