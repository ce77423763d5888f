// `thimble run`: the experiment with the real processes over UDP, in real time, one trial per modality and
// delay; then the same trials in virtual time, to see whether both ways agree. Or by another clock (docs/clocks.md).
#pragma once

#include <array>
#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/error.hpp"
#include "common/network_settings.hpp"
#include "common/runtime/runtime_settings.hpp"
#include "session/launch/node_starter.hpp"
#include "session/records/trial_table.hpp"
#include "session/run/condition_run.hpp"
#include "session/settings/system_settings.hpp"
#include "thimble/commands/step_prompt.hpp"

namespace thimble {

enum class RunClock : std::uint8_t { kWall, kLockStep, kVirtual };
inline constexpr std::array<std::string_view, 3> kRunClockNames{"wall", "lock-step", "virtual"};
constexpr const char* to_string(RunClock clock) {
    return kRunClockNames[static_cast<std::size_t>(clock)].data();
}

struct RunOptions {
    std::shared_ptr<NodeStarter> starter;  // none: steer nodes that run already, over the network they have
    std::filesystem::path out;
    std::string command;                                           // as typed, for the report's provenance
    std::vector<std::pair<std::string, std::string>> made_with{};  // more of it
    NetworkSettings network;
    RuntimeSettings runtime;
    RunClock clock = RunClock::kWall;
    Duration answer_limit = std::chrono::seconds{60};  // of a node in lock-step
    std::shared_ptr<StepPrompt> step;                  // there: lock-step pauses and asks
    bool overwrite = false;
    bool strict_rt = false;
    const std::atomic<bool>* stop = nullptr;
    // The observer of every condition, for an experimenter's view, and whether the view has asked to stop. Empty: no
    // observer.
    MakeObserver make_observer{};
    std::function<bool()> quit{};
};

struct RunResult {
    ExitCode code = ExitCode::kOk;
    std::string problem;
    std::vector<TrialRow> rows;  // as in trials.csv
    std::vector<TrialRow>
        virtual_rows;  // the same trials in virtual time, virtual.csv; of a virtual run: none
};

// The trials of one delay, in order.
std::vector<TrialConditions> run_trials_of(const SystemSettings& settings, double delay_s);

// How many of the delays have their trials at the same time, each on ports of its own. `elsewhere`: other machines take part.
unsigned conditions_at_once(const SystemSettings& settings, std::size_t delays, bool elsewhere,
                            RunClock clock = RunClock::kWall);

// Writes trials.csv, trajectories/, nodes/ (logs and reports), report.html and summary.json below
// options.out.
RunResult run_session(const SystemSettings& settings, const RunOptions& options);

}  // namespace thimble
