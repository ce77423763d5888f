#include "study/board/board_row.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <functional>
#include <iterator>
#include <numeric>

#include <fmt/format.h>

#include "analysis/statistics/descriptive.hpp"
#include "common/csv/csv.hpp"
#include "common/error.hpp"
#include "common/process/apart.hpp"
#include "common/random.hpp"

namespace thimble {
namespace {

constexpr Duration kPluginPatience = std::chrono::minutes{2};  // for a row of a Python file's controller, too
constexpr std::size_t kResamples = 1000;
constexpr std::uint32_t kBootstrapStream = 32;  // in the place of an experiment's number

double mean_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

BoardValue bootstrapped(const std::vector<double>& values, std::uint64_t seed) {
    if (values.empty()) return {};
    BoardValue value;
    value.mean = value.low = value.high = mean_of(values);
    if (values.size() < 2) return value;
    RandomStream stream({seed, kBootstrapStream, 0, 0, Purpose::kParameter});
    std::vector<double> means(kResamples);
    for (double& mean : means) {
        mean = 0;
        for (std::size_t i = 0; i < values.size(); ++i)
            mean += values[stream.below(static_cast<std::uint32_t>(values.size()))];
        mean /= static_cast<double>(values.size());
    }
    std::sort(means.begin(), means.end());
    const auto tail = static_cast<std::size_t>(0.5 * (1 - kBoardConfidence) * kResamples);
    value.low = means[tail];
    value.high = means[kResamples - 1 - tail];
    return value;
}

BoardValue share_of(const std::vector<double>& flags) {
    const auto successes = static_cast<std::size_t>(std::count(flags.begin(), flags.end(), 1.0));
    const auto interval = wilson_interval(successes, flags.size(), kBoardConfidence);
    return {mean_of(flags), interval.low, interval.high};
}

// A field of the table: one line, no comma.
std::string as_field(std::string text) {
    std::replace(text.begin(), text.end(), ',', ';');
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r' || c == '"'; }, ' ');
    return text;
}

// Of a row, as it comes back from a process of its own.
struct Outcome {
    std::array<BoardValue, kBoardMeasures> values{};
    std::uint32_t trials = 0, subject = 0;
};

void run_trials_of(const BoardPlan& plan, const BoardPlace& place, BoardRow& row) {
    const std::string session = row_session(plan, place);
    const SystemSettings settings = read_system_settings(ConfigFile::parse(session, row_name(place)));
    std::vector<BoardTrial> trials;
    trials.reserve(plan.trials);
    for (std::uint32_t subject = 1; subject <= plan.trials; ++subject) {
        trials.push_back(run_board_trial(settings, plan.seed, subject));
        const bool bad = !trials.back().completed || trials.back().values[kOscillating] > 0;
        if (bad && row.subject == 0) row.subject = subject;
    }
    condense(trials, plan.seed, row);
}

// A plug-in is loaded and runs in a process of its own, because it may crash, hang or end the program.
void run_plugin_apart(const BoardPlan& plan, const BoardPlace& place, BoardRow& row) {
    const ApartResult apart = run_apart(
        [&] {
            run_trials_of(plan, place, row);
            return bytes_of(Outcome{row.values, row.trials, row.subject});
        },
        kPluginPatience);
    if (!apart.bytes) throw Error(ExitCode::kRunFailed, "{}", apart.failure);
    std::string_view bytes = *apart.bytes;
    const auto outcome = take_plain<Outcome>(bytes);
    row.values = outcome.values;
    row.trials = outcome.trials;
    row.subject = outcome.subject;
}

// Why a row has no measures. A refused session cannot be: wave variables with a codec, for instance.
std::string reason_of(const std::exception& failure, bool plugin) {
    const auto* const error = dynamic_cast<const Error*>(&failure);
    const bool refused = !plugin && error != nullptr && error->code() == ExitCode::kUsage;
    return as_field((refused ? std::string(kNotPossible) : std::string()) + failure.what());
}

}  // namespace

void condense(const std::vector<BoardTrial>& trials, std::uint64_t seed, BoardRow& row) {
    row.trials = static_cast<std::uint32_t>(trials.size());
    for (std::size_t m = 0; m < kBoardMeasures; ++m) {
        std::vector<double> values;
        values.reserve(trials.size());
        for (const BoardTrial& trial : trials)
            if (std::isfinite(trial.values[m])) values.push_back(trial.values[m]);
        const bool share = m == kOscillating || m == kNotCompleted;
        row.values[m] = share ? share_of(values) : bootstrapped(values, seed);
    }
}

BoardRow run_board_row(const BoardPlan& plan, std::size_t number) {
    const BoardPlace place = place_of(plan, number);
    BoardRow row;
    row.controller = place.controller.name;
    row.codec = place.codec.name;
    row.condition = place.condition.name;
    row.network = place.condition.network;
    row.hands = place.condition.hands;
    row.tissue = place.condition.tissue;
    row.scene = place.condition.scene;
    row.delay_s = place.condition.delay_s;
    row.jitter_s = place.condition.jitter_s;
    row.loss = place.condition.loss;
    const BoardRow empty = row;
    try {
        (place.controller.plugin ? run_plugin_apart : run_trials_of)(plan, place, row);
    } catch (const std::exception& failure) {
        row = empty;
        row.status = reason_of(failure, place.controller.plugin);
    }
    return row;
}

}  // namespace thimble
