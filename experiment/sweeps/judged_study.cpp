#include "experiment/sweeps/judged_study.hpp"

#include "experiment/no_lag.hpp"
#include "experiment/study.hpp"

namespace thimble {
namespace {

// False if it was stopped.
bool run_into(std::vector<TrialRow>& rows, const SystemSettings& settings,
              const std::vector<TrialConditions>& trials, const SweepOptions& options) {
    return run_trials(settings, trials, thread_count(options.jobs), options.stop,
                      [&](const TrialRecord& record) { rows.push_back(make_row(record)); });
}

}  // namespace

std::optional<std::vector<Claim>> judge_study(const SystemSettings& settings, const SweepOptions& options,
                                              std::uint64_t seed) {
    std::vector<Protocol> protocols = options.protocols;
    for (Protocol& protocol : protocols) protocol.seed = seed;
    std::vector<TrialRow> rows, no_lag;
    const bool complete = run_into(rows, settings, all_trials(protocols), options) &&
                          run_into(no_lag, without_lag(settings), no_lag_trials(protocols), options);
    if (!complete) return std::nullopt;
    return judge_claims(rows, no_lag);
}

}  // namespace thimble
