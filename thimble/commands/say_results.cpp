#include "thimble/commands/say_results.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iostream>
#include <string>

#include <fmt/format.h>

#include "analysis/claims/headline.hpp"
#include "session/records/condition_summary.hpp"

namespace thimble {
namespace {

std::string number_text(double value) { return std::isnan(value) ? "-" : fmt::format("{:.2f}", value); }

void say_condition(std::uint32_t experiment, const ConditionSummary& c) {
    const Statistic& displacement = c.of(Metric::kPeakDisplacement);
    fmt::print(
        "experiment {} {:>6} {:<4} {:3} trials, {:3} oscillate, maximum penetration {:>6} mm, "
        "completion {:>5} s{}\n",
        experiment, delay_text(c.delay_s), to_string(c.modality), c.trials, c.oscillating,
        number_text(1000 * c.of(Metric::kPenetrationMax).mean),
        number_text(c.of(Metric::kCompletionTime).mean),
        displacement.n > 0 ? fmt::format(", peak displacement {} mm", number_text(1000 * displacement.mean))
                           : "");
}

}  // namespace

void say_results(bool json, const std::filesystem::path& folder, const std::vector<TrialRow>& rows) {
    if (json) {
        std::ifstream summary(folder / "summary.json");
        std::cout << summary.rdbuf();
        return;
    }
    for (const std::uint32_t experiment : {1U, 2U, 3U}) {
        for (const ConditionSummary& c : summarize(of_experiment(rows, experiment))) {
            say_condition(experiment, c);
        }
    }
    const auto delayed = [](const TrialRow& row) { return row.conditions.delay_s > 0; };
    if (std::any_of(rows.begin(), rows.end(), delayed)) {
        fmt::print("{}\n", judge_headline(summarize(without_removals(rows))).sentence());
    }
    fmt::print("report: {}\n", (folder / "report.html").string());
}

}  // namespace thimble
