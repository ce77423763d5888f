// One condition of a real-time run: its plan, its events, its result.
#pragma once

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/csv/csv_file.hpp"
#include "common/error.hpp"
#include "common/log/log_settings.hpp"
#include "common/network_settings.hpp"
#include "common/runtime/runtime_settings.hpp"
#include "common/runtime/sockets.hpp"
#include "session/clocks/clock_summary.hpp"
#include "session/launch/node_starter.hpp"
#include "session/run/session_process.hpp"

namespace thimble {

// Reads a session, and may send orders.
class Observer : public Process {
  public:
    // In lock-step: the next session of the condition, which outlives the observer or is replaced. `ahead`: of tick()'s clock, of
    // the session's.
    virtual void serve(const SessionProcess& session, Duration ahead) = 0;
};
// `condition` is ConditionPlan::name.
using MakeObserver =
    std::function<std::unique_ptr<Observer>(SessionProcess&, Sockets&, const std::string& condition)>;

struct ConditionPlan {
    std::shared_ptr<NodeStarter> starter;  // none: the user has started the nodes, and they go on running
    std::filesystem::path out;
    NetworkSettings network;
    SessionSettings session;
    double delay_s = 0;  // of the force path
    std::string name{};  // among conditions that run at the same time, "50ms"; empty: there is no other
    unsigned place = 0;  // among them
    std::vector<TrialConditions> trials;
    // The loop calls the observer right after the session, with the session's clock. The sockets that it opens wake the loop.
    // Empty: the session has no observer.
    MakeObserver make_observer{};
    RuntimeSettings runtime{};
    bool strict_rt = false;
    Duration answer_limit = std::chrono::seconds{60};  // of a node in lock-step
    // A program waits for a datagram only after its sender has answered, so no debugger delays it.
    Duration datagram_limit() const { return std::min<Duration>(answer_limit, std::chrono::seconds{60}); }
    // The messages that session and nodes log, in NAME_<delay>ms.mcap in `out`.
    LogSettings log{LoggedMessages::kNone, {}, {}};
    std::filesystem::path session_file{};  // kept with it
    IfExists if_exists = IfExists::kRefuse;
    bool holds_stop = false;  // the kept stop is this program's own, which raises it again
};

struct ConditionEvents {
    std::function<void(const TrialRecord&)> trial_done;  // may be empty, as the next two
    std::function<void(const TrialConditions&, const TrajectorySample&)> progress;  // twice a second
    std::function<bool()> stop;
};

struct ConditionResult {
    ExitCode code = ExitCode::kOk;
    std::string problem;      // why it ended early; empty if it did not
    std::string write_fault;  // why a file lacks data, whatever else ended the run; empty: none does
    std::vector<nlohmann::ordered_json> reports;  // one per node that could still write it
    std::vector<NodeClock> clocks;
    double simulated_s = 0;  // of the session's clock, all trials together
};

// Why a program could not write its log, by its report, which a program of a user may have written; empty: it could.
inline std::string log_fault_in(const nlohmann::ordered_json& report) {
    if (!report.contains("log") || !report["log"].contains("fault")) return {};
    const auto& fault = report["log"]["fault"];
    return fault.is_string() ? fault.get<std::string>() : std::string();
}

}  // namespace thimble
