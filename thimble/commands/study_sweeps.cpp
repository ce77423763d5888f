#include "thimble/commands/study_sweeps.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "study/sweeps/variation.hpp"

namespace thimble {
namespace {

int finish(const SweepOptions& options, bool complete, const std::string& what) {
    const auto report = options.out / "report.html";
    if (std::filesystem::exists(report)) fmt::print("results: {}\n", report.string());
    if (!complete) spdlog::error("interrupted: {} that are done are saved", what);
    return static_cast<int>(complete ? ExitCode::kOk : ExitCode::kRunFailed);
}

void say(const ClaimTally& tally, const char* what) {
    const auto& counts = tally.counts();
    if (std::none_of(counts.begin(), counts.end(), [](const ClaimCount& c) { return c.judgeable; })) {
        fmt::print("{}.\n", claims_sentence({}));
        return;
    }
    fmt::print("How often each claim is reproduced; fragile: in fewer than {:.0f} % of {}\n",
               100 * kFragileBelow, what);
    for (const ClaimCount& c : counts) {
        if (!c.judgeable) continue;
        fmt::print("{:>4.0f} % of {} {} {:<18} {}\n", 100 * c.fraction(), c.studies, what, c.claim.id,
                   c.fragile() ? "fragile: " + c.claim.claim : c.claim.claim);
    }
}

void say(const Variation& variation) {
    if (shown_claims(variation).empty()) {
        fmt::print("{}.\n", claims_sentence({}));
        return;
    }
    fmt::print("How often each claim is reproduced, in percent of the seeds\n{:<18}", variation.range.name());
    for (const VariedPoint& point : variation.points) fmt::print(" {:>7g}", point.value);
    fmt::print("\n");
    const auto& claims = variation.points.front().tally.counts();
    for (const std::size_t i : shown_claims(variation)) {
        fmt::print("{:<18}", claims[i].claim.id);
        for (const VariedPoint& point : variation.points) {
            fmt::print(" {:>5.0f} %", 100 * point.tally.counts()[i].fraction());
        }
        fmt::print("\n");
    }
}

std::vector<ParameterRange> ranges_of(const SweepRequest& request) {
    std::vector<ParameterRange> ranges;
    for (const std::string& text : request.vary) {
        ranges.push_back(parse_parameter_range(text));
        if ((request.draws == 0) == (ranges.back().points == 0)) {
            throw Error(
                ExitCode::kUsage,
                fmt::format("--vary {}: {}", text,
                            request.draws == 0
                                ? "give the number of points: NAME=LOW:HIGH:POINTS"
                                : "with --draws, values are random: give NAME=LOW:HIGH without points"));
        }
    }
    return ranges;
}

}  // namespace

int sweep_seeds(const SystemSettings& settings, const SweepOptions& options) {
    const TallyResult result = run_sweep(settings, options);
    say(result.tally, "seeds");
    return finish(options, result.complete, fmt::format("the {} seeds", result.tally.studies()));
}

int sweep_parameters(const std::filesystem::path& config, const SweepRequest& request, SweepOptions options) {
    const std::vector<ParameterRange> ranges = ranges_of(request);
    if (request.draws == 0) {
        const VariationResult result = run_variations(config, ranges, options);
        for (const Variation& variation : result.variations) say(variation);
        return finish(options, result.complete, "the studies");
    }
    options.seeds = request.draws;
    const TallyResult result = run_draws(config, ranges.empty() ? documented_ranges() : ranges, options);
    say(result.tally, "draws");
    return finish(options, result.complete, fmt::format("the {} draws", result.tally.studies()));
}

}  // namespace thimble
