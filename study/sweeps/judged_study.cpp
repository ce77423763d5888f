#include "study/sweeps/judged_study.hpp"

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/text_file.hpp"
#include "common/version.hpp"
#include "study/study.hpp"

namespace thimble {
namespace {

// False if it was stopped.
bool run_into(std::vector<TrialRow>& rows, const SystemSettings& settings,
              const std::vector<TrialConditions>& trials, const SweepOptions& options) {
    return run_trials(settings, trials, thread_count(options.jobs), options.stop,
                      [&](const TrialRecord& record) { rows.push_back(make_row(record)); });
}

}  // namespace

void claim_folder(const SweepOptions& options) {
    const auto report = options.out / "report.html";
    if (options.if_exists != IfExists::kReplace && std::filesystem::exists(report)) {
        throw Error(
            ExitCode::kUsage,
            fmt::format("{}: exists; --overwrite replaces it, --out names another folder", report.string()));
    }
    make_folder(options.out);
    for (const char* name : {"report.html", "claims.json", "vary.json"}) {
        std::filesystem::remove(options.out / name);
    }
}

std::vector<std::pair<std::string, std::string>> sweep_provenance(const SweepOptions& options,
                                                                  const std::string& what,
                                                                  std::uint32_t studies, bool complete) {
    return {{"command", options.command},
            {"first seed", std::to_string(options.protocols[0].seed)},
            {what, std::to_string(studies)},
            {"version", kVersion},
            {"complete", complete ? "yes" : "no, interrupted"}};
}

std::optional<std::vector<Claim>> judge_study(const SystemSettings& settings, const SweepOptions& options,
                                              std::uint64_t seed) {
    std::vector<Protocol> protocols = options.protocols;
    for (Protocol& protocol : protocols) {
        protocol.seed = seed;
        // These, too, may be what is varied.
        protocol.fixture_position_m = settings.slave.fixture_position_m();
        protocol.fixture_jitter_m = settings.plan.fixture_jitter_m;
    }
    std::vector<TrialRow> rows, no_lag;
    const bool complete = run_into(rows, settings, all_trials(protocols), options) &&
                          run_into(no_lag, without_lag(settings), no_lag_trials(protocols), options);
    if (!complete) return std::nullopt;
    return judge_claims(rows, no_lag);
}

}  // namespace thimble
