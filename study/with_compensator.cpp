#include "study/with_compensator.hpp"

#include <algorithm>
#include <iterator>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"

namespace thimble {

ControlSettings control_for(const SystemSettings& settings, Compensator compensator) {
    if (settings.master.control.compensator == compensator) return settings.master.control;
    if (compensator == Compensator::kPlugin)
        throw Error(ExitCode::kUsage,
                    "compensator plugin: the session names no plug-in: set [control] plugin");
    ControlSettings control;
    control.compensator = compensator;
    return control;
}

SystemSettings with_control(SystemSettings settings, const ControlSettings& control) {
    settings.master.control = control;
    settings.cutaneous.hand_share = control.hand_share();
    settings.slave.control.control = control;
    // Each packet carries the waves of its own sample.
    if (control.compensator == Compensator::kWave) settings.master.codec = settings.slave.codec = {};
    return settings;
}

std::vector<TrialConditions> force_feedback_trials(const std::vector<Protocol>& protocols) {
    const std::vector<TrialConditions> all = all_trials(protocols);
    std::vector<TrialConditions> trials;
    trials.reserve(all.size());
    std::copy_if(all.begin(), all.end(), std::back_inserter(trials),
                 [](const TrialConditions& trial) { return trial.modality == Modality::kHF; });
    return trials;
}

void name_compensators(std::vector<TrialConditions>& trials, const SystemSettings& settings) {
    for (TrialConditions& trial : trials) {
        trial.compensator =
            trial.modality == Modality::kHF ? settings.master.control.compensator : Compensator::kNone;
    }
}

Compensator parse_compensator(std::string_view name) {
    const auto* const found = std::find(kCompensatorNames.begin() + 1, kCompensatorNames.end(), name);
    if (found != kCompensatorNames.end()) return static_cast<Compensator>(found - kCompensatorNames.begin());
    const std::vector<std::string_view> known(kCompensatorNames.begin() + 1, kCompensatorNames.end());
    throw Error(ExitCode::kUsage,
                fmt::format("'{}' is not a delay compensator: choose from {}", name, fmt::join(known, ", ")));
}

}  // namespace thimble
