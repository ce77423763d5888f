#include "study/no_lag.hpp"

#include <algorithm>
#include <iterator>

namespace thimble {

std::vector<TrialConditions> no_lag_trials(const std::vector<Protocol>& protocols) {
    std::vector<TrialConditions> again;
    for (const Protocol& protocol : protocols) {
        if (protocol.experiment != 1) continue;
        const std::vector<TrialConditions> all = all_trials({protocol});
        std::copy_if(all.begin(), all.end(), std::back_inserter(again),
                     [](const TrialConditions& trial) { return trial.modality == Modality::kCF; });
    }
    return again;
}

SystemSettings without_lag(SystemSettings settings) {
    settings.cutaneous.dead_time = Duration{0};
    settings.cutaneous.time_constant = Duration{0};
    return settings;
}

}  // namespace thimble
