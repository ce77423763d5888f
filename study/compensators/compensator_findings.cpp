#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/statistics/descriptive.hpp"
#include "common/error.hpp"
#include "study/compensators/compensator_report.hpp"

namespace thimble {
namespace {

// Less is better in each of these.
struct Contest {
    std::string_view what, unit;
    int decimals;
    double shown_per_si;
    double CompensatorRow::*of_row;
    double TrialMetrics::*of_trial;
};
constexpr std::array<Contest, 3> kContests{
    {{"maximum penetration", "mm", 2, 1000, &CompensatorRow::penetration_max_m,
      &TrialMetrics::penetration_max_m},
     {"completion time", "s", 2, 1, &CompensatorRow::completion_time_s, &TrialMetrics::completion_time_s},
     {"peak-to-peak movement in the hold", "mm", 2, 1000, &CompensatorRow::oscillation_peak_to_peak_m,
      &TrialMetrics::oscillation_peak_to_peak_m}}};

std::string joined(const std::vector<std::string>& words) {
    return fmt::format("{}", fmt::join(words, ", "));
}

std::string ordinal(std::size_t n) {
    const bool teen = n % 100 >= 11 && n % 100 <= 13;
    const char* const end = teen ? "th" : n % 10 == 1 ? "st" : n % 10 == 2 ? "nd" : n % 10 == 3 ? "rd" : "th";
    return fmt::format("{}{}", n, end);
}

// Mean per subject over its trials; subjects without a value are left out.
std::map<std::uint32_t, double> subject_means(const std::vector<CompensatorTrial>& trials,
                                              std::size_t condition, std::string_view network,
                                              const Contest& contest) {
    std::map<std::uint32_t, std::pair<double, int>> sums;
    for (const CompensatorTrial& trial : trials) {
        if (trial.condition != condition || trial.network.name != network) continue;
        const double value = trial.metrics.*contest.of_trial;
        if (!std::isfinite(value)) continue;
        auto& [sum, count] = sums[trial.conditions.subject];
        sum += value;
        ++count;
    }
    std::map<std::uint32_t, double> means;
    for (const auto& [subject, sum] : sums) means[subject] = sum.first / sum.second;
    return means;
}

class Findings {
  public:
    Findings(const std::vector<CompensatorRow>& rows, const std::vector<CompensatorTrial>& trials)
        : rows_(rows), trials_(trials), conditions_(conditions_in(rows)), networks_(networks_in(rows)) {}

    std::vector<std::string> all() {
        without_compensator();
        stability();
        for (const CompensatorNetwork& network : networks_) {
            if (network.delay_s <= 0) continue;
            for (const Contest& contest : kContests) cf_against_best(network, contest);
        }
        cost();
        return std::move(sentences_);
    }

  private:
    std::size_t index_of(std::string_view condition) const {
        return static_cast<std::size_t>(std::find(conditions_.begin(), conditions_.end(), condition) -
                                        conditions_.begin());
    }

    void without_compensator() {
        std::vector<std::string> parts;
        for (const CompensatorNetwork& network : networks_) {
            const CompensatorRow* const row = find_row(rows_, "HF", network.name);
            if (row == nullptr) continue;
            parts.push_back(fmt::format("{} of {} over {} ({} completed)", row->oscillating, row->trials,
                                        network.name, row->completed));
        }
        if (!parts.empty())
            sentences_.push_back("HF without a compensator oscillates in " + joined(parts) + ".");
    }

    void stability() {
        std::vector<std::string> everywhere, somewhere;
        for (const std::string& condition : conditions_) {
            std::vector<std::string> failures;
            for (const CompensatorNetwork& network : networks_) {
                const CompensatorRow* const row = find_row(rows_, condition, network.name);
                if (row == nullptr || is_stable(*row)) continue;
                failures.push_back(fmt::format("{}: {} completed, {} oscillating of {}", network.name,
                                               row->completed, row->oscillating, row->trials));
            }
            if (failures.empty()) {
                everywhere.push_back(condition);
            } else if (condition != "HF") {
                somewhere.push_back(fmt::format("{} ({})", condition, fmt::join(failures, "; ")));
            }
        }
        if (!everywhere.empty())
            sentences_.push_back(
                "Stable over every network compared, so every trial was completed and none oscillated: " +
                joined(everywhere) + ".");
        if (!somewhere.empty())
            sentences_.push_back("Not stable over every network: " + joined(somewhere) + ".");
    }

    // Those that are stable over this network, the least first.
    std::vector<const CompensatorRow*> ranking(const CompensatorNetwork& network,
                                               const Contest& contest) const {
        std::vector<const CompensatorRow*> ranked;
        for (const CompensatorRow& row : rows_) {
            if (row.network.name == network.name && is_stable(row) && std::isfinite(row.*contest.of_row))
                ranked.push_back(&row);
        }
        std::stable_sort(ranked.begin(), ranked.end(), [&](const CompensatorRow* a, const CompensatorRow* b) {
            return a->*contest.of_row < b->*contest.of_row;
        });
        return ranked;
    }

    void cf_against_best(const CompensatorNetwork& network, const Contest& contest) {
        const std::vector<const CompensatorRow*> ranked = ranking(network, contest);
        const auto cf = std::find_if(ranked.begin(), ranked.end(),
                                     [](const CompensatorRow* row) { return row->name == "CF"; });
        if (cf == ranked.end() || ranked.size() < 2) return;
        const auto text = [&](const CompensatorRow& row) {
            return fmt::format("{:.{}f} {}", contest.shown_per_si * row.*contest.of_row, contest.decimals,
                               contest.unit);
        };
        if (cf == ranked.begin()) {
            sentences_.push_back(fmt::format(
                "{}: CF is best in {} ({}); the next is {} ({}){}.", network.name, contest.what, text(**cf),
                ranked[1]->name, text(*ranked[1]), difference(network, contest, ranked[1]->name, "CF")));
            return;
        }
        const std::string place = ordinal(static_cast<std::size_t>(cf - ranked.begin()) + 1);
        sentences_.push_back(fmt::format("{}: CF is not best in {}: {}, {} of the {} stable; {} has {}{}.",
                                         network.name, contest.what, text(**cf), place, ranked.size(),
                                         ranked[0]->name, text(*ranked[0]),
                                         difference(network, contest, "CF", ranked[0]->name)));
    }

    // First minus second over subjects, with its interval; nothing where there are too few.
    std::string difference(const CompensatorNetwork& network, const Contest& contest, std::string_view first,
                           std::string_view second) const {
        const auto a = subject_means(trials_, index_of(first), network.name, contest);
        const auto b = subject_means(trials_, index_of(second), network.name, contest);
        NamedValues differences{"difference", {}};
        for (const auto& [subject, value] : a) {
            const auto other = b.find(subject);
            if (other != b.end())
                differences.values.push_back(contest.shown_per_si * (value - other->second));
        }
        try {
            const ConfidenceInterval interval = mean_interval(differences, 0.95);
            return fmt::format(", less by {:.{}f} {} (95 % interval {:.{}f} to {:.{}f}, {} subjects{})",
                               sample_mean(differences), contest.decimals, contest.unit, interval.low,
                               contest.decimals, interval.high, contest.decimals, differences.values.size(),
                               interval.low <= 0 && interval.high >= 0 ? ": no difference was found" : "");
        } catch (const Error&) {
            return "";
        }
    }

    void cost() {
        for (const CompensatorNetwork& network : networks_) {
            if (network.delay_s <= 0) continue;
            std::vector<std::string> feel, apart;
            for (const CompensatorRow& row : rows_) {
                if (row.network.name != network.name || !is_stable(row)) continue;
                if (row.rendered_stiffness > 0)
                    feel.push_back(fmt::format("{} {:.1f}", row.name, 100 * row.rendered_stiffness));
                if (row.drift_needle_m > 0.1e-3)
                    apart.push_back(fmt::format("{} {:.1f} mm", row.name, 1000 * row.drift_needle_m));
            }
            if (feel.empty()) continue;
            sentences_.push_back(fmt::format(
                "{}: stiffness that the hand feels, in percent of the fixture's: {}; 0 in CF, CCF and VF{}.",
                network.name, joined(feel),
                apart.empty() ? "" : "; hand and needle differ by more than 0.1 mm with " + joined(apart)));
        }
    }

    const std::vector<CompensatorRow>& rows_;
    const std::vector<CompensatorTrial>& trials_;
    std::vector<std::string> conditions_;
    std::vector<CompensatorNetwork> networks_;
    std::vector<std::string> sentences_;
};

}  // namespace

std::vector<std::string> compensator_findings(const std::vector<CompensatorRow>& rows,
                                              const std::vector<CompensatorTrial>& trials) {
    return Findings(rows, trials).all();
}

}  // namespace thimble
