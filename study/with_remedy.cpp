#include "study/with_remedy.hpp"

#include <algorithm>
#include <iterator>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"

namespace thimble {

ControlSettings control_for(const SystemSettings& settings, Remedy remedy) {
    if (settings.master.control.remedy == remedy) return settings.master.control;
    ControlSettings control;
    control.remedy = remedy;
    return control;
}

SystemSettings with_control(SystemSettings settings, const ControlSettings& control) {
    settings.master.control = control;
    settings.cutaneous.hand_share = control.hand_share();
    settings.slave.wave = wave_end_of(control, settings.slave.wave);
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

void name_remedies(std::vector<TrialConditions>& trials, const SystemSettings& settings) {
    for (TrialConditions& trial : trials) {
        trial.remedy = trial.modality == Modality::kHF ? settings.master.control.remedy : Remedy::kNone;
    }
}

Remedy parse_remedy(std::string_view name) {
    const auto* const found = std::find(kRemedyNames.begin() + 1, kRemedyNames.end(), name);
    if (found != kRemedyNames.end()) return static_cast<Remedy>(found - kRemedyNames.begin());
    const std::vector<std::string_view> known(kRemedyNames.begin() + 1, kRemedyNames.end());
    throw Error(ExitCode::kUsage,
                fmt::format("'{}' is no remedy: choose from {}", name, fmt::join(known, ", ")));
}

}  // namespace thimble
