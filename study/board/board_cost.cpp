// The time that a millisecond of a session takes with each contestant. It is the only wall-clock time of the board, so it has a file of
// its own, whose bytes differ from run to run.
#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/wall_clock.hpp"
#include "study/board/board_report.hpp"

namespace thimble {
namespace {

constexpr std::uint32_t kCostTrials = 3;

// Times between two samples of one trial, in order of size.
std::vector<double> steps_us(const SystemSettings& settings, std::uint64_t seed, std::uint32_t subject) {
    std::vector<double> steps;
    SessionTime last = wall_now();
    run_board_trial(settings, seed, subject, [&] {
        const SessionTime now = wall_now();
        steps.push_back(1e6 * to_seconds(now - last));
        last = now;
    });
    std::sort(steps.begin(), steps.end());
    return steps;
}

std::optional<SystemSettings> possible_session(const BoardPlan& plan, const BoardPlace& place) {
    try {
        return read_system_settings(ConfigFile::parse(row_session(plan, place), row_name(place)));
    } catch (const Error&) {
        return std::nullopt;  // its row says why
    }
}

}  // namespace

std::vector<BoardCost> measure_costs(const BoardPlan& plan) {
    std::vector<BoardCost> costs;
    costs.reserve(plan.controllers.size() * plan.codecs.size());
    for (std::size_t row = 0; row < plan.rows(); row += plan.conditions.size()) {
        const BoardPlace place = place_of(plan, row);
        if (!place.controller.plugin.empty()) continue;  // it could crash here
        BoardCost cost{place.controller.name, place.codec.name};
        const auto settings = possible_session(plan, place);
        if (!settings) continue;
        for (std::uint32_t subject = 1; subject <= kCostTrials; ++subject) {
            const std::vector<double> steps = steps_us(*settings, plan.seed, subject);
            if (steps.empty() || !(steps.back() < cost.worst_us)) continue;
            cost.median_us = steps[steps.size() / 2];
            cost.most_us = steps[steps.size() - 1 - steps.size() / 1000];
            cost.worst_us = steps.back();
        }
        costs.push_back(cost);
    }
    return costs;
}

std::string cost_csv(const std::vector<BoardCost>& costs) {
    std::string text = "controller,codec,step_median_us,step_999_us,step_worst_us\n";
    for (const BoardCost& cost : costs)
        text += fmt::format("{},{},{:.2f},{:.2f},{:.2f}\n", cost.controller, cost.codec, cost.median_us,
                            cost.most_us, cost.worst_us);
    return text;
}

}  // namespace thimble
