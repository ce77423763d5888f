// Findings in words and tables. Every word follows from a number: who is deeper, and whether that can be said at all.
#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "analysis/claims/claim_findings.hpp"
#include "analysis/findings.hpp"

namespace thimble {
namespace {

// An effect of fewer subjects is mostly chance.
constexpr std::size_t kFewestForEffect = 6;

struct Phrase {
    std::string_view name, unit, more, less;  // "HF was 3.9 mm shallower than CF"
};

Phrase phrase_of(Metric metric) {
    switch (metric) {
        case Metric::kPenetrationMean:
            return {"mean penetration", "mm", "deeper", "shallower"};
        case Metric::kPenetrationMax:
            return {"maximum penetration", "mm", "deeper", "shallower"};
        case Metric::kCompletionTime:
            return {"completion time", "s", "slower", "faster"};
        case Metric::kPeakDisplacement:
            return {"peak displacement", "mm", "further displaced", "less displaced"};
        default:
            return {info(metric).name, "", "larger", "smaller"};
    }
}

// Three digits, which no small difference loses.
std::string size_text(double value, Metric metric) {
    return fmt::format("{:.3g}", value * info(metric).shown_per_si);
}

std::string shown_range(ConfidenceInterval interval, Metric metric) {
    return fmt::format("{} to {}", size_text(interval.low, metric), size_text(interval.high, metric));
}

std::string share_text(const ConfidenceInterval& share) {
    return fmt::format("{:.0f} to {:.0f} %", 100 * share.low, 100 * share.high);
}

std::string sample_text(const ConditionPair& c) {
    return c.paired ? counted(c.n, "subject") : counted(c.n, "trial");
}

std::string too_few_text(const ConditionPair& c) {
    const std::string pairs = c.family > 1 ? fmt::format(", with {} pairs compared at once", c.family) : "";
    if (c.paired) return fmt::format("at least {} subjects are needed{}", c.fewest(), pairs);
    return fmt::format("at least {} trials of each are needed{}", c.fewest(), pairs);
}

ReportTable oscillation_shares(const std::vector<GroupFindings>& groups) {
    ReportTable table{"Which conditions oscillate",
                      fmt::format("A trial oscillates if the needle leaves the fixture at least {} times and "
                                  "moves by more than {:g} mm rms during the hold, which lasts from {:g} s "
                                  "after the first contact to the beep. Only trials count that ran to their "
                                  "end and touched the fixture. Interval: Wilson's, for independent trials.",
                                  kOscillationContactsLost, kOscillationRms_m * 1e3, kHoldSettling_s),
                      {"delay", "condition", "trials", "subjects", "oscillating", "share, 95 % interval"}};
    for (const GroupFindings& group : groups) {
        for (const OscillationShare& share : group.oscillations) {
            table.rows.push_back({group.name, share.condition, fmt::format("{}", share.trials),
                                  fmt::format("{}", share.subjects), fmt::format("{}", share.oscillating),
                                  share.interval ? share_text(*share.interval) : std::string(kDash)});
        }
    }
    return table;
}

std::vector<std::string> row_of(const ConditionPair& c, const GroupFindings& group) {
    const std::string dash(kDash);
    const bool judged = c.can_be_judged();
    return {group.name,
            std::string(info(c.metric).label),
            fmt::format("{} - {}", c.first, c.second),
            fmt::format("{}", c.n),
            c.shift ? size_text(c.shift->estimate, c.metric) : dash,
            judged ? shown_range(*c.shift->interval, c.metric) : dash,
            judged ? fmt::format("{:.2g}", c.shift->p) : dash,
            judged && c.n >= kFewestForEffect ? fmt::format("{:.2f}", c.shift->rank_biserial) : dash};
}

bool any_judged(const std::vector<GroupFindings>& groups) {
    return std::any_of(groups.begin(), groups.end(), [](const GroupFindings& group) {
        return std::any_of(group.comparisons.begin(), group.comparisons.end(),
                           [](const ConditionPair& c) { return c.can_be_judged(); });
    });
}

constexpr const char* kTested =
    "First minus second condition. P: Wilcoxon signed-rank test of the differences within subjects, exact up "
    "to 200 subjects. Difference: Hodges-Lehmann estimate, with the confidence interval of the same test. "
    "The trials of experiment 2 are independent, so its test is the rank-sum test. Interval and P hold for "
    "all pairs of a measure at once (Bonferroni). r: rank-biserial correlation, 1 if all subjects agree.";
constexpr const char* kOnlySeen =
    "First minus second condition: Hodges-Lehmann estimate. There are too few data for a test and its "
    "interval.";

ReportTable comparisons(const std::vector<GroupFindings>& groups) {
    ReportTable table{"Differences",
                      any_judged(groups) ? kTested : kOnlySeen,
                      {"delay", "measure", "pair", "n", "difference", "95 % interval", "P", "r"}};
    for (const GroupFindings& group : groups) {
        for (const ConditionPair& c : group.comparisons) table.rows.push_back(row_of(c, group));
    }
    drop_empty_columns(table);
    return table;
}

}  // namespace

std::string name_of(Metric metric) { return std::string(phrase_of(metric).name); }

std::string counted(std::size_t n, const std::string& thing) {
    return fmt::format("{} {}{}", n, thing, n == 1 ? "" : "s");
}

std::string list_text(const std::vector<std::string>& names) {
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i)
        text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
    return text;
}

std::string difference_text(const ConditionPair& c) {
    const Phrase phrase = phrase_of(c.metric);
    const double estimate = c.shift->estimate;
    if (estimate == 0) return fmt::format("{} and {} had the same {}", c.first, c.second, phrase.name);
    return fmt::format("{} was {} {} {} than {}", c.first, size_text(std::abs(estimate), c.metric),
                       phrase.unit, estimate > 0 ? phrase.more : phrase.less, c.second);
}

std::string interval_text(const ConditionPair& c) {
    ConfidenceInterval interval = *c.shift->interval;
    if (c.apart() && c.shift->estimate < 0) interval = {-interval.high, -interval.low};
    return fmt::format("{} {}", shown_range(interval, c.metric), phrase_of(c.metric).unit);
}

std::string words(const OscillationShare& share, const GroupFindings& group) {
    if (share.trials == 0)
        return fmt::format("No trial of {} at {} touched the fixture and ran to its end.", share.condition,
                           group.name);
    return fmt::format("{} {} at {}: {} of {} (95 % interval {}; {}).", share.condition,
                       share.oscillating == 0 ? "does not oscillate"
                       : share.mostly()       ? "oscillates"
                                              : "oscillates in some trials",
                       group.name, share.oscillating, counted(share.trials, "trial"),
                       share_text(*share.interval), counted(share.subjects, "subject"));
}

std::string words(const ConditionPair& c, const GroupFindings& group) {
    const std::string where = fmt::format("{} at {}", name_of(c.metric), group.name);
    if (!c.shift) return fmt::format("No subject has both {} and {} in {}.", c.first, c.second, where);
    if (!c.can_be_judged())
        return fmt::format("{} and {} cannot be compared in {} with {}: {}.", c.first, c.second, where,
                           sample_text(c), too_few_text(c));
    const std::string numbers = fmt::format("{}; {}", p_text(c.shift->p), sample_text(c));
    if (c.apart())
        return fmt::format("{} in {} (95 % interval {}; {}).", difference_text(c), where, interval_text(c),
                           numbers);
    return fmt::format(
        "No difference was found between {} and {} in {}: {} - {} is between {} (95 % interval; {}).",
        c.first, c.second, where, c.first, c.second, interval_text(c), numbers);
}

std::vector<ReportTable> finding_tables(const std::vector<GroupFindings>& groups) {
    std::vector<ReportTable> tables{oscillation_shares(groups), comparisons(groups)};
    std::erase_if(tables, [](const ReportTable& table) { return table.rows.empty(); });
    return tables;
}

}  // namespace thimble
