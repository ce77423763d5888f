#include "study/fit/fit.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/process/progress.hpp"
#include "common/text_file.hpp"
#include "study/fit/operator_model.hpp"
#include "study/fit/simulation_file.hpp"
#include "study/planned_table.hpp"
#include "study/worker_pool.hpp"

namespace thimble {
namespace {

constexpr std::size_t kFitDraws = 2000;

// Text of all settings that decide the simulated trials.
std::string fit_plan(const SystemSettings& settings, const FitOptions& options,
                     const RecordedTrials& recorded) {
    std::string text = fmt::format("seed {}\nsimulations {}\nsubject {}\n", options.seed, options.simulations,
                                   options.subject);
    for (const ObservedTrial& trial : recorded.trials)
        text += fmt::format("trial {} {} {} {} {}\n", trial.conditions.experiment, trial.conditions.trial,
                            to_string(trial.conditions.modality), trial.conditions.delay_s,
                            trial.conditions.fixture_position_m);
    return text + session_text(settings);
}

// No trait stands for these keys, so prior and emulator would describe other people.
void require_fitted_traits(const SystemSettings& settings) {
    const auto require_off = [&settings](const char* key, double value) {
        if (value <= 0) return;
        throw Error(ExitCode::kUsage,
                    "{}: [operator] {} is {:g}, but thimble fit cannot estimate it: leave the key out of the "
                    "session file, or name another session with --session",
                    settings.file.empty() ? "the settings" : settings.file.string(), key, value);
    };
    require_off("press_N", settings.person.behaviour.press_N);
    require_off("spread_experience", settings.person.spread.experience);
}

class Fitter {
  public:
    Fitter(const SystemSettings& settings, const FitOptions& options)
        : settings_(settings),
          options_(options),
          recorded_(recorded_trials(options.folder, options.subject, options.experiment)),
          groups_(groups_of(recorded_.trials)) {}

    FitResult run() {
        result_.trials = recorded_.trials.size();
        result_.left_out = recorded_.left_out;
        if (!simulate()) return std::move(result_);
        const OperatorModel model(settings_.person, groups_, training_);
        check_held_out(model);
        const std::vector<TraitScores> draws = model.posterior(recorded_.trials, options_.seed, kFitDraws);
        const std::vector<FittedKey> keys = fitted_keys(settings_.person);
        for (const FittedKey& key : keys) result_.keys.push_back(summarise(key, draws));
        write_posterior(keys, draws);
        write_result();
        return std::move(result_);
    }

  private:
    static std::vector<FitGroup> groups_of(const std::vector<ObservedTrial>& trials) {
        std::vector<TrialConditions> conditions;
        conditions.reserve(trials.size());
        for (const ObservedTrial& trial : trials) conditions.push_back(trial.conditions);
        return fit_groups(conditions);
    }

    bool simulate() {
        const std::string plan = fit_plan(settings_, options_, recorded_);
        SimulationFile file(options_.out, options_.if_exists, plan);
        const std::size_t pairs = (options_.simulations + 1) / 2;
        training_ = file.earlier();
        for (std::size_t i = 0; i < training_.size(); ++i)
            if (training_[i])
                training_[i]->traits = traits_of(settings_, training_pair(groups_, options_.seed, i).front());
        const std::size_t done = training_.size();
        using Pair = std::optional<SimulatedPair>;
        Progress progress;
        const auto pair = [&](std::size_t i) {
            return simulate_pair(settings_, training_pair(groups_, options_.seed, done + i));
        };
        const auto take = [&](const Pair& simulated) {
            file.append(simulated);
            training_.push_back(simulated);
            progress.count(2 * training_.size(), 2 * pairs, "trials", "simulated people");
        };
        result_.complete =
            run_in_order<Pair>(pairs - std::min(done, pairs), options_.jobs, options_.stop, pair, take,
                               ResultsGo::kToAll, [&] { return fmt::format("{} {}", done, plan); });
        if (result_.complete) file.close();
        return result_.complete;
    }

    // Predicts the last trial of each condition from the others.
    void check_held_out(const OperatorModel& model) {
        std::vector<ObservedTrial> kept, held_out;
        for (const ObservedTrial& trial : recorded_.trials) {
            const bool last = std::any_of(groups_.begin(), groups_.end(), [&](const FitGroup& group) {
                return group.has(trial.conditions) && group.trials.back().trial == trial.conditions.trial;
            });
            (last ? held_out : kept).push_back(trial);
        }
        const std::vector<TraitScores> draws = model.posterior(kept, options_.seed, kFitDraws);
        for (const ObservedTrial& trial : held_out) {
            result_.held_out += kFeatureNames.size();
            result_.held_out_inside += model.predicted(trial, draws, options_.seed + trial.conditions.trial);
        }
    }

    void write_posterior(const std::vector<FittedKey>& keys, const std::vector<TraitScores>& draws) const {
        std::string text;
        for (const FittedKey& key : keys) text += (text.empty() ? "" : ",") + key.key;
        for (const TraitScores& scores : draws) {
            text += '\n';
            for (std::size_t i = 0; i < keys.size(); ++i)
                text += fmt::format("{}{}", i > 0 ? "," : "", keys[i].value(scores));
        }
        write_text_file(options_.out / "posterior.csv", text + "\n");
    }

    void write_result() const {
        nlohmann::ordered_json json{{"subject", options_.subject},
                                    {"trials", result_.trials},
                                    {"trials_left_out", result_.left_out},
                                    {"simulations", options_.simulations},
                                    {"seed", options_.seed}};
        json["parameters"] = nlohmann::ordered_json::object();
        json["not_identifiable"] = nlohmann::ordered_json::array();
        for (const KeySummary& key : result_.keys) {
            json["parameters"][key.key] = {{"median", key.median},
                                           {"low", key.low},
                                           {"high", key.high},
                                           {"population_low", key.population_low},
                                           {"population_high", key.population_high},
                                           {"narrowed", key.narrowed}};
            if (!key.identifiable()) json["not_identifiable"].push_back(key.key);
        }
        json["held_out"] = {{"features", result_.held_out}, {"inside_90_percent", result_.held_out_inside}};
        write_text_file(options_.out / "fit.json", json_text(json, 2) + "\n");
    }

    const SystemSettings& settings_;
    const FitOptions& options_;
    RecordedTrials recorded_;
    std::vector<FitGroup> groups_;
    std::vector<std::optional<SimulatedPair>> training_;
    FitResult result_;
};

}  // namespace

SystemSettings simulated_settings(SystemSettings settings) {
    settings.handle.kind = HandleKind::kSimulated;
    settings.plan.kind = SubjectKind::kVirtual;
    return settings;
}

FitResult run_fit(const SystemSettings& settings, const FitOptions& options) {
    require_fitted_traits(settings);
    return Fitter(settings, options).run();
}

std::filesystem::path fit_file(const std::filesystem::path& fit) {
    return std::filesystem::is_directory(fit) ? fit / "fit.json" : fit;
}

std::vector<SettingChange> read_fit(const std::filesystem::path& fit) {
    const auto path = fit_file(fit);
    std::ifstream file(path);
    const auto json = nlohmann::json::parse(file, nullptr, false);
    std::vector<SettingChange> changes;
    if (json.is_object() && json.contains("parameters") && json["parameters"].is_object())
        for (const auto& [key, value] : json["parameters"].items())
            if (value.is_object() && value.contains("median") && value["median"].is_number())
                changes.push_back({key, value["median"].get<double>()});
    if (changes.empty())
        throw Error(ExitCode::kData,
                    "{}: holds no results of a fit: name a folder that thimble fit has written",
                    path.string());
    return changes;
}

std::vector<SettingChange> twin_of(const std::filesystem::path& fit) {
    std::vector<SettingChange> changes = read_fit(fit);
    const std::vector<SettingChange> equal = without_spread();
    changes.insert(changes.end(), equal.begin(), equal.end());
    return changes;
}

}  // namespace thimble
