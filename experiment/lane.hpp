// One condition of a real-time run: five node processes on loopback, a session that steers them through its
// trials, everything recorded as it comes.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/network_settings.hpp"
#include "experiment/child.hpp"
#include "experiment/session_process.hpp"
#include "experiment/trajectory_file.hpp"

namespace thimble {

struct LanePlan {
    std::filesystem::path config;    // session file for the nodes; empty: defaults
    std::filesystem::path programs;  // folder of the thimble-* programs
    std::filesystem::path out;
    NetworkSettings network;
    SessionSettings session;
    double delay_s = 0;  // of the force path
    std::vector<TrialConditions> trials;
    bool strict_rt = false;
    bool attach = false;  // the nodes run already, started by somebody else, and go on running
    IfExists if_exists = IfExists::kRefuse;
};

struct LaneEvents {
    std::function<void(const TrialRecord&)> trial_done;
    std::function<void(const TrialConditions&, const TrajectorySample&)> progress;  // twice a second
    std::function<bool()> stop;
};

struct LaneResult {
    ExitCode code = ExitCode::kOk;
    std::string problem;                          // why it ended early; empty if it did not
    std::vector<nlohmann::ordered_json> reports;  // one per node that could still write it
};

// Runs the lane to its end. Throws Error if it cannot start: network, with the words of the node that failed.
LaneResult run_lane(const LanePlan& plan, const LaneEvents& events);

}  // namespace thimble
