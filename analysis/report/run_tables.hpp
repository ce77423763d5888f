// Tables of how well the machine kept time during a real-time run.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "analysis/text/html.hpp"
#include "common/histogram.hpp"
#include "common/network_settings.hpp"
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
bool runs_elsewhere(const NodeStarter& starter);
ReportTable machine_table(const NodeStarter& starter, const NetworkSettings& network);
// Handle to handle through all processes at 0 ms against a bare ping-pong times the number of hops.
ReportTable round_trip_table(const std::vector<TrialRow>& rows, const Histogram& bare);

}  // namespace thimble
