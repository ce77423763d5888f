#include "bench/network/chain_rounds.hpp"

#include <fstream>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "session/launch/local_starter.hpp"
#include "session/run/condition_run.hpp"
#include "session/settings/system_settings.hpp"
#include "thimble/commands/run.hpp"

namespace thimble {
namespace {

using Json = nlohmann::ordered_json;

// A number below two keys of a node's report.
double number(const std::vector<Json>& reports, const std::string& program, const char* table,
              const char* key) {
    for (const Json& report : reports) {
        if (!report.is_object() || report.value("program", "") != program) continue;
        const auto found = report.find(table);
        if (found != report.end() && found->is_object() && found->contains(key) && found->at(key).is_number())
            return found->at(key).get<double>();
        throw Error(ExitCode::kData, fmt::format("the report of {} has no number {}.{}: is it of another "
                                                 "version than thimble-bench?",
                                                 program, table, key));
    }
    throw Error(ExitCode::kData,
                fmt::format("no report of {}: it did not end in order, see its log", program));
}

std::filesystem::path write_session(const ChainSettings& settings) {
    auto path = settings.scratch / "session.toml";
    std::ofstream file(path);
    file << fmt::format("[runtime]\nrealtime_scheduling = {}\npriority = {}\n",
                        settings.runtime.realtime_scheduling, settings.runtime.priority);
    if (!settings.lab_key.empty())
        file << fmt::format("[security]\nmode = 'lab-key'\nkey_file = '{}'\n", settings.lab_key.string());
    if (!file.flush())
        throw Error(ExitCode::kData, fmt::format("cannot write '{}': is the disk full?", path.string()));
    return path;
}

ConditionPlan plan_of(const ChainSettings& settings, const TrialConditions& trial) {
    ConditionPlan plan;
    plan.starter = std::make_shared<LocalStarter>(settings.programs, write_session(settings));
    plan.out = settings.scratch / "nodes";
    plan.network.base_port = settings.base_port;
    if (!settings.lab_key.empty())
        plan.network.security = {SecurityMode::kLabKey, true, false, settings.lab_key.string()};
    SystemSettings system = load_system_settings({});
    set_delay(system.netem.force, system.netem.force_timeline, Duration::zero());
    plan.session = session_settings(system);
    plan.session.trial_timeout = settings.window;
    plan.trials = {trial};
    plan.if_exists = IfExists::kReplace;
    return plan;
}

}  // namespace

ChainRound read_chain_round(const std::vector<Json>& reports) {
    const auto master = [&](const char* table, const char* key) {
        return number(reports, "thimble-master", table, key);
    };
    ChainRound round;
    round.round_trip = {master("round_trip", "median_us"), master("round_trip", "p99_us"),
                        master("round_trip", "worst_us"),
                        static_cast<std::size_t>(master("round_trip", "count"))};
    round.hold_us = master("hold", "median_us");
    round.master_turn_us = master("turns", "median_us");
    round.netem_turn_us = number(reports, "thimble-netem", "turns", "median_us");
    round.slave_turn_us = number(reports, "thimble-slave-sim", "turns", "median_us");
    return round;
}

std::vector<TrialConditions> chain_trials() { return run_trials_of(load_system_settings({}), 0); }

ChainWindow run_window(const ChainSettings& settings, const TrialConditions& trial) {
    const ConditionPlan plan = plan_of(settings, trial);
    ChainWindow window;
    ConditionEvents events;
    events.trial_done = [&window](const TrialRecord& record) { window.reason = record.reason; };
    events.stop = [] { return stop_requested().load(); };
    ConditionResult result = run_condition(plan, events);
    window.code = result.code;
    window.problem = std::move(result.problem);
    window.reports = std::move(result.reports);
    return window;
}

ChainRound run_chain(const ChainSettings& settings, const TrialConditions& trial) {
    const ChainWindow result = run_window(settings, trial);
    if (result.code != ExitCode::kOk) throw Error(result.code, result.problem);
    return read_chain_round(result.reports);
}

}  // namespace thimble
