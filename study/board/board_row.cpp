#include "study/board/board_row.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <functional>
#include <iterator>
#include <numeric>
#include <optional>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "analysis/statistics/descriptive.hpp"
#include "common/csv/csv.hpp"
#include "common/error.hpp"
#include "common/process/isolated.hpp"
#include "common/process/progress.hpp"
#include "common/random.hpp"
#include "study/board/board_plan.hpp"
#include "study/planned_table.hpp"
#include "study/worker_pool.hpp"

namespace thimble {
namespace {

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
    const auto tail = static_cast<std::size_t>(std::lround(0.5 * (1 - kBoardConfidence) * kResamples));
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

SystemSettings settings_of(const BoardPlan& plan, const BoardPlace& place) {
    return read_system_settings(ConfigFile::parse(row_session(plan, place), row_name(place)));
}

// A plug-in is loaded and runs in a process of its own, because it may crash, hang or end the program.
BoardTrial plugin_trial(const BoardPlan& plan, const BoardPlace& place, std::uint32_t subject) {
    const IsolatedResult apart =
        run_isolated([&] { return bytes_of(run_board_trial(settings_of(plan, place), plan.seed, subject)); });
    if (!apart.bytes) throw Error(ExitCode::kRunFailed, "{}", apart.failure);
    std::string_view bytes = *apart.bytes;
    return take_plain<BoardTrial>(bytes);
}

void run_trials_of(const BoardPlan& plan, const BoardPlace& place, BoardRow& row) {
    std::optional<SystemSettings> own;
    if (place.controller.plugin.empty()) own = settings_of(plan, place);
    std::vector<BoardTrial> trials;
    trials.reserve(plan.trials);
    for (std::uint32_t subject = 1; subject <= plan.trials; ++subject) {
        trials.push_back(own ? run_board_trial(*own, plan.seed, subject)
                             : plugin_trial(plan, place, subject));
        const bool bad = !trials.back().completed || trials.back().values[kOscillating] > 0;
        if (bad && row.subject == 0) row.subject = subject;
    }
    condense(trials, plan.seed, row);
}

// True for wave variables with a codec: each alone is valid, both together are not.
bool exclude_each_other(const BoardPlace& place) {
    const auto settings_with = [&](const BoardEntry& entry) {
        const std::array fragments{place.condition.keys, entry.keys};
        const std::string name = row_name(place);
        return read_system_settings(ConfigFile::parse(joined_fragments(fragments, name), name));
    };
    try {
        return settings_with(place.controller).master.control.compensator == Compensator::kWave &&
               settings_with(place.codec).slave.codec.used();
    } catch (const Error&) {
        return false;
    }
}

// Why a row has no measures.
std::string reason_of(const std::exception& failure, const BoardPlace& place) {
    const bool impossible = place.controller.plugin.empty() && exclude_each_other(place);
    return as_field((impossible ? std::string(kNotPossible) : std::string()) + failure.what());
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
        run_trials_of(plan, place, row);
    } catch (const std::exception& failure) {
        row = empty;
        row.status = reason_of(failure, place);
    }
    return row;
}

bool run_board(const BoardPlan& plan, const BoardOptions& options) {
    PlannedTable table(options.out, "board", "board", plan_text(plan), board_header(), options.if_exists,
                       {"board.html", "board.json", "board_cost.csv"});
    const std::size_t first = table.done();
    if (first > 0) spdlog::info("{} of {} rows were already done", first, plan.rows());
    Progress progress;
    const auto row = [&](std::size_t i) { return board_line(run_board_row(plan, first + i)); };
    const auto take = [&](const std::string& line) {
        const std::string name = row_name(place_of(plan, table.done()));
        table.append(line);
        progress.count(table.done(), plan.rows(), "rows", name);
    };
    return run_in_order<std::string>(plan.rows() - first, options.jobs, options.stop, row, take,
                                     ResultsGo::kToFirst,
                                     [&] { return fmt::format("{} {}", first, plan_text(plan)); });
}

}  // namespace thimble
