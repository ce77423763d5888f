#include "study/swarm/swarm.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/json_text.hpp"
#include "common/process/progress.hpp"
#include "common/text_file.hpp"
#include "study/ordered_workers.hpp"

namespace thimble {
namespace {

// One case in so many runs twice, and both must have the same digest.
constexpr std::uint64_t kTwiceEvery = 64;

struct Judged {
    SwarmCase drawn;
    SwarmOutcome outcome;
};

Judged judge(const SwarmOptions& options, const std::vector<KeyDeclaration>& keys, std::uint64_t seed) {
    Judged judged{draw_case(keys, seed), {}};
    judged.drawn.plugin = options.plugin;
    judged.outcome = run_case(judged.drawn, options.break_force);
    if (judged.outcome.violation || seed % kTwiceEvery != 0) return judged;
    if (run_case(judged.drawn, options.break_force).digest != judged.outcome.digest)
        judged.outcome.violation =
            Violation{Rule::kSameBits, {}, "a second run had other forces, scenes or samples"};
    return judged;
}

void tally(SwarmResult& result, const Judged& judged) {
    ++result.cases;
    result.trials += judged.outcome.ends.size();
    result.simulated_s += judged.outcome.simulated_s;
    for (const SwarmFault& fault : judged.drawn.faults)
        ++result.faults.at(static_cast<std::size_t>(fault.kind));
    for (const EndReason reason : judged.outcome.ends) ++result.ends.at(static_cast<std::size_t>(reason));
}

SwarmFailure make_failure(const SwarmOptions& options, const Judged& judged) {
    SwarmFailure failure;
    failure.seed = judged.drawn.seed;
    failure.violation = *judged.outcome.violation;
    failure.smallest = shrink(judged.drawn, failure.violation.rule, options.break_force);
    if (options.out.empty()) return failure;
    make_folder(options.out);
    failure.file = options.out / fmt::format("seed{}.toml", failure.seed);
    write_text_file(failure.file, fmt::format("# breaks {}: {}\n{}", name_of(failure.violation.rule),
                                              failure.violation.text, case_text(failure.smallest)));
    return failure;
}

}  // namespace

SwarmResult run_swarm(const SwarmOptions& options) {
    const std::vector<KeyDeclaration> keys = drawable_keys(options.plugin);
    SwarmResult result;
    Progress progress;
    OrderedWorkers<Judged> workers(
        options.cases, thread_count(options.jobs),
        [&](std::size_t i) { return judge(options, keys, options.seed + i); }, options.stop);
    while (result.cases < options.cases && result.failures.size() < options.most_failures) {
        const std::optional<Judged> judged = workers.take();
        if (!judged) return result;
        tally(result, *judged);
        if (judged->outcome.violation) result.failures.push_back(make_failure(options, *judged));
        progress.count(result.cases, options.cases, "cases",
                       fmt::format("{} failed", result.failures.size()));
    }
    result.complete = result.cases == options.cases;
    return result;
}

std::string failure_text(const SwarmFailure& failure) {
    const Violation& v = failure.violation;
    std::string text = fmt::format("seed {}: {} at {:.4f} s: {}\n", failure.seed, name_of(v.rule),
                                   to_seconds(v.at.time_since_epoch()), v.text);
    text += fmt::format("  repeat it: {}\n", repeat_command(failure.smallest));
    if (!failure.file.empty())
        text += fmt::format("  smallest session that fails: {}\n", failure.file.string());
    return text;
}

std::string swarm_json(const SwarmOptions& options, const SwarmResult& result) {
    nlohmann::ordered_json json{{"seed", options.seed},
                                {"cases", result.cases},
                                {"complete", result.complete},
                                {"trials", result.trials},
                                {"simulated_s", result.simulated_s}};
    for (std::size_t i = 0; i < result.faults.size(); ++i) json["faults"][kFaultNames[i]] = result.faults[i];
    for (std::size_t i = 1; i < result.ends.size(); ++i)
        json["ends"][to_string(static_cast<EndReason>(i))] = result.ends[i];
    json["failures"] = nlohmann::ordered_json::array();
    for (const SwarmFailure& f : result.failures) {
        json["failures"].push_back({{"seed", f.seed},
                                    {"invariant", name_of(f.violation.rule)},
                                    {"text", f.violation.text},
                                    {"smallest", case_text(f.smallest)}});
    }
    return json_text(json, 2) + "\n";
}

}  // namespace thimble
