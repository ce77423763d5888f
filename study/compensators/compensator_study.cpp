#include "study/compensators/compensator_study.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/process/isolated.hpp"
#include "session/records/condition_summary.hpp"
#include "session/records/metrics.hpp"
#include "session/settings/protocol.hpp"
#include "session/virtual/virtual_session.hpp"
#include "study/compensators/hand_record.hpp"
#include "study/loop_limits.hpp"
#include "study/planned_table.hpp"
#include "study/study.hpp"
#include "study/with_compensator.hpp"
#include "study/worker_pool.hpp"

namespace thimble {
namespace {

// Waves have to wait for the jitter too; everything else takes what comes.
ControlSettings control_over(const CompensatorNetwork& network, ControlSettings control) {
    control.jitter += 2 * from_seconds(network.jitter_spread_s);
    return control;
}

// `words`: of a plug-in's values that are no numbers.
CompensatorOutcome outcome_of(const SystemSettings& settings, const TrialConditions& conditions,
                              std::string& words) {
    VirtualSession session(settings);
    HandRecord hand;
    session.session().set_sample_hook([&](const TrajectorySample& sample) { hand.add(session, sample); });
    const TrialRecord& record = session.run(conditions);
    CompensatorOutcome outcome;
    outcome.metrics = measure(record);
    outcome.completed = record.reason == EndReason::kCompleted && outcome.metrics.beeped;
    const HandMeasures felt = hand.measured(record, outcome.metrics, settings);
    outcome.rendered_stiffness = felt.rendered_stiffness;
    outcome.drift_needle_m = felt.drift_needle_m;
    words = plugin_text(session);
    return outcome;
}

// If a plug-in fails, its trial counts as not completed.
CompensatorOutcome plugin_outcome(const SystemSettings& settings, const TrialConditions& conditions) {
    const IsolatedResult apart = run_isolated([&] {
        std::string words;
        const CompensatorOutcome outcome = outcome_of(settings, conditions, words);
        return bytes_of(outcome) + words;
    });
    if (!apart.bytes) {
        spdlog::error("trial {}: {}", conditions.trial, apart.failure);
        return {};
    }
    std::string_view bytes = *apart.bytes;
    const auto outcome = take_plain<CompensatorOutcome>(bytes);
    if (!bytes.empty()) spdlog::warn("trial {}: {}", conditions.trial, bytes);
    return outcome;
}

void run_trial(const SystemSettings& settings, const CompensatorCondition& condition,
               CompensatorTrial& trial) {
    ControlSettings control = control_over(trial.network, condition.control);
    if (control.compensator == Compensator::kScaled) control.share = trial.share;
    const SystemSettings with = with_control(over_network(settings, trial.network), control);
    const bool plugin = control.compensator == Compensator::kPlugin;
    std::string none;
    static_cast<CompensatorOutcome&>(trial) =
        plugin ? plugin_outcome(with, trial.conditions) : outcome_of(with, trial.conditions, none);
}

// There and back, jitter included.
double longest_delay_s(const SystemSettings& settings, const CompensatorNetwork& network) {
    return to_seconds(session_settings(over_network(settings, network)).network_delay);
}

CompensatorRow condensed(std::span<const CompensatorTrial> trials,
                         const std::vector<CompensatorCondition>& conditions) {
    CompensatorRow row;
    row.name = conditions[trials.front().condition].name;
    row.network = trials.front().network;
    row.share = trials.front().share;
    for (const CompensatorTrial& trial : trials) {
        ++row.trials;
        row.completed += trial.completed ? 1 : 0;
        row.oscillating += trial.metrics.oscillates ? 1 : 0;
    }
    for (const CompensatorValue& value : kCompensatorValues) {
        double sum = 0, count = 0;
        for (const CompensatorTrial& trial : trials) {
            if (!std::isfinite(value.of(trial))) continue;
            sum += value.of(trial);
            ++count;
        }
        if (count > 0) row.*value.of_row = sum / count;
    }
    return row;
}

}  // namespace

std::vector<CompensatorCondition> compensator_conditions(const SystemSettings& settings) {
    std::vector<CompensatorCondition> conditions;
    conditions.reserve(kModalities.size() + kCompensatorNames.size());
    for (const Modality modality : kModalities) conditions.push_back({to_string(modality), modality, {}});
    const bool plugin = settings.master.control.compensator == Compensator::kPlugin;
    for (std::size_t i = 1; i < (plugin ? kCompensatorNames : kBuiltInCompensators).size(); ++i) {
        conditions.push_back({std::string(kCompensatorNames[i]), Modality::kHF,
                              control_for(settings, static_cast<Compensator>(i))});
    }
    return conditions;
}

double stable_share(const SystemSettings& settings, double delay_s, double margin) {
    const HeldHandle held = held_handle(settings);
    const double whole_N_per_m = true_stiffness_hand_N_per_m(settings);
    if (!(whole_N_per_m > 0)) return 1;  // nothing that could oscillate
    const double loop_s = delay_s + 0.5 * to_seconds(settings.master.sample_period);
    if (critical_delay_s(held, whole_N_per_m) > loop_s) return 1;
    double stable = 0, unstable = 1;
    for (int i = 0; i < 50; ++i) {
        const double share = 0.5 * (stable + unstable);
        (critical_delay_s(held, share * whole_N_per_m) > loop_s ? stable : unstable) = share;
    }
    return margin * stable;
}

std::vector<std::string> names_of(const std::vector<CompensatorCondition>& conditions) {
    std::vector<std::string> names;
    names.reserve(conditions.size());
    for (const CompensatorCondition& condition : conditions) names.push_back(condition.name);
    return names;
}

std::vector<CompensatorCondition> chosen_conditions(const SystemSettings& settings,
                                                    const std::vector<std::string>& names) {
    std::vector<CompensatorCondition> all = compensator_conditions(settings);
    if (names.empty()) return all;
    const std::vector<std::string> known = names_of(all);
    for (const std::string& name : names) {
        if (std::find(known.begin(), known.end(), name) == known.end())
            throw Error(ExitCode::kUsage,
                        fmt::format("'{}' is neither a modality nor a delay compensator: choose from {}",
                                    name, fmt::join(known, ", ")));
    }
    std::erase_if(all, [&](const CompensatorCondition& condition) {
        return std::find(names.begin(), names.end(), condition.name) == names.end();
    });
    return all;
}

std::vector<CompensatorNetwork> plain_networks(const std::vector<double>& delays_s) {
    std::vector<CompensatorNetwork> networks;
    networks.reserve(delays_s.size());
    for (const double delay_s : delays_s) networks.push_back({delay_text(delay_s), delay_s, 0, 0});
    return networks;
}

double true_stiffness_hand_N_per_m(const SystemSettings& settings) {
    return settings.master.position_scale * settings.master.force_scale *
           fixture_stiffness_N_per_m(settings.slave);
}

SystemSettings over_network(SystemSettings settings, const CompensatorNetwork& network) {
    settings = with_force_delay(std::move(settings), from_seconds(network.delay_s));
    if (network.jitter_spread_s > 0)
        settings.netem.force.jitter = {JitterShape::kUniform, from_seconds(network.jitter_spread_s)};
    if (network.loss > 0)
        settings.netem.force.loss = settings.netem.needle.loss = LossSettings::independent(network.loss);
    return settings;
}

std::string compensator_plan(const SystemSettings& settings, const CompensatorStudyOptions& options) {
    std::string text = fmt::format(
        "seed {}\nsubjects {}\ntrials {}\nconditions {}\n", options.seed, options.subjects, options.trials,
        options.names.empty() ? "all" : fmt::format("{}", fmt::join(options.names, " ")));
    for (const CompensatorNetwork& network : options.networks)
        text += fmt::format("network {}: {} s, jitter {} s, loss {}\n", network.name, network.delay_s,
                            network.jitter_spread_s, network.loss);
    return text + session_text(settings);
}

std::vector<CompensatorTrial> plan_compensator_trials(const SystemSettings& settings,
                                                      const CompensatorStudyOptions& options) {
    const std::vector<CompensatorCondition> conditions = chosen_conditions(settings, options.names);
    const Protocol protocol = experiment_3(settings, options.subjects, options.seed);
    std::vector<CompensatorTrial> trials;
    trials.reserve(conditions.size() * options.networks.size() * options.subjects * options.trials);
    for (std::size_t c = 0; c < conditions.size(); ++c) {
        const bool scaled = conditions[c].control.compensator == Compensator::kScaled;
        for (const CompensatorNetwork& network : options.networks) {
            CompensatorTrial trial;
            trial.condition = c;
            trial.network = network;
            if (scaled) trial.share = stable_share(settings, longest_delay_s(settings, network));
            for (std::uint32_t subject = 1; subject <= options.subjects; ++subject) {
                for (std::uint32_t number = 1; number <= options.trials; ++number) {
                    trial.conditions = {options.seed,
                                        protocol.experiment,
                                        subject,
                                        number,
                                        conditions[c].modality,
                                        network.delay_s,
                                        draw_fixture_position_m(protocol, subject, number),
                                        false,
                                        conditions[c].control.compensator};
                    trials.push_back(trial);
                }
            }
        }
    }
    return trials;
}

bool run_compensator_trials(const SystemSettings& settings, const CompensatorStudyOptions& options,
                            std::span<CompensatorTrial> trials,
                            const std::function<void(const CompensatorTrial&)>& take) {
    const std::vector<CompensatorCondition> conditions = chosen_conditions(settings, options.names);
    const auto outcome = [&](std::size_t i) {
        CompensatorTrial trial = trials[i];
        run_trial(settings, conditions[trial.condition], trial);
        return static_cast<const CompensatorOutcome&>(trial);  // what comes back from a rank
    };
    std::size_t done = 0;
    const auto take_outcome = [&](const CompensatorOutcome& result) {
        CompensatorTrial& trial = trials[done++];
        static_cast<CompensatorOutcome&>(trial) = result;
        take(trial);
    };
    return run_in_order<CompensatorOutcome>(trials.size(), options.jobs, options.stop, outcome, take_outcome,
                                            ResultsGo::kToAll,
                                            [&] { return compensator_plan(settings, options); });
}

std::vector<CompensatorRow> condense(const SystemSettings& settings, const CompensatorStudyOptions& options,
                                     const std::vector<CompensatorTrial>& trials) {
    const std::vector<CompensatorCondition> conditions = chosen_conditions(settings, options.names);
    const std::size_t each = std::size_t{options.subjects} * options.trials;
    std::vector<CompensatorRow> rows;
    rows.reserve(trials.size() / each);
    for (std::size_t first = 0; first < trials.size(); first += each)
        rows.push_back(condensed(std::span(trials).subspan(first, each), conditions));
    return rows;
}

std::vector<CompensatorRow> run_compensator_study(const SystemSettings& settings,
                                                  const CompensatorStudyOptions& options) {
    std::vector<CompensatorTrial> trials = plan_compensator_trials(settings, options);
    if (!run_compensator_trials(settings, options, trials, [](const CompensatorTrial&) {})) return {};
    return condense(settings, options, trials);
}

}  // namespace thimble
