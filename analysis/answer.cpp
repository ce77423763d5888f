// The answer in three sentences: which conditions oscillate, how modalities differ, what cannot be said.
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/findings.hpp"

namespace thimble {
namespace {

using Groups = std::vector<GroupFindings>;
using Texts = std::vector<std::string>;

// Without the mean penetration, which agrees with the maximum; the table has it.
constexpr std::array kAnswered{Metric::kPenetrationMax, Metric::kCompletionTime, Metric::kPeakDisplacement};
constexpr std::size_t kMostListed = 6;

std::string sentence(std::string text) {
    if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
    return text + ".";
}

// ---- which conditions oscillate

std::string of_trials(std::size_t oscillating, std::size_t trials) {
    return fmt::format("{} of {}", oscillating, counted(trials, "trial"));
}

std::string with_interval(const OscillationShare& share) {
    return fmt::format("{} oscillates in {} (95 % interval {:.0f} to {:.0f} %)", share.condition,
                       of_trials(share.oscillating, share.trials), 100 * share.interval->low,
                       100 * share.interval->high);
}

struct Silent {
    Texts names;
    std::size_t trials = 0;
    void add(const std::string& name, std::size_t more) {
        names.push_back(name);
        trials += more;
    }
};

std::string oscillating_text(const GroupFindings& group) {
    Texts loud;
    Silent silent;
    for (const OscillationShare& share : group.oscillations) {
        if (share.oscillating > 0) {
            loud.push_back(with_interval(share));
        } else if (share.trials > 0) {
            silent.add(share.condition, share.trials);
        }
    }
    std::string text = fmt::format("at {} {}", group.name, list_text(loud));
    if (silent.trials == 0) return text;
    return text + fmt::format(", and {} {} not ({})", list_text(silent.names),
                              silent.names.size() == 1 ? "does" : "do", of_trials(0, silent.trials));
}

bool oscillates(const GroupFindings& group) {
    return std::any_of(group.oscillations.begin(), group.oscillations.end(),
                       [](const OscillationShare& share) { return share.oscillating > 0; });
}

std::size_t trials_of(const GroupFindings& group) {
    std::size_t trials = 0;
    for (const OscillationShare& share : group.oscillations) trials += share.trials;
    return trials;
}

std::string no_condition_text(const GroupFindings& group) {
    return group.oscillations.size() == 1
               ? fmt::format("{} does not oscillate", group.oscillations[0].condition)
               : "no condition oscillates";
}

std::string oscillation_sentence(const Groups& groups) {
    Texts parts;
    Silent silent;
    std::string nothing;
    for (const GroupFindings& group : groups) {
        if (oscillates(group)) {
            parts.push_back(oscillating_text(group));
        } else if (trials_of(group) > 0) {
            silent.add("at " + group.name, trials_of(group));
            nothing = silent.names.size() == 1 ? no_condition_text(group) : "no condition oscillates";
        }
    }
    if (silent.trials > 0)
        parts.push_back(
            fmt::format("{} {} ({})", list_text(silent.names), nothing, of_trials(0, silent.trials)));
    if (parts.empty())
        return "No trial ran to its end and touched the fixture, so the results say nothing about "
               "oscillation.";
    return sentence(fmt::format("{}", fmt::join(parts, "; ")));
}

// ---- how modalities differ

template <class Wanted>
std::vector<const ConditionPair*> chosen(const GroupFindings& group, Metric metric, const Wanted& wanted) {
    std::vector<const ConditionPair*> found;
    for (const ConditionPair& comparison : group.comparisons) {
        if (comparison.metric == metric && wanted(comparison)) found.push_back(&comparison);
    }
    return found;
}

const ConditionPair& largest(const std::vector<const ConditionPair*>& comparisons) {
    return **std::max_element(comparisons.begin(), comparisons.end(), [](auto* a, auto* b) {
        return std::abs(a->shift->estimate) < std::abs(b->shift->estimate);
    });
}

std::string apart_text(const std::vector<const ConditionPair*>& apart) {
    const ConditionPair& c = largest(apart);
    std::string pairs = "the only pair compared";
    if (c.family > 1)
        pairs = fmt::format("the largest of {} differences among {} pairs", apart.size(), c.family);
    if (c.family > 1 && apart.size() == 1)
        pairs = fmt::format("the only difference found among {} pairs", c.family);
    return fmt::format("{} in {} (95 % interval {}; {})", difference_text(c), name_of(c.metric),
                       interval_text(c), pairs);
}

// Of `wanted` comparisons one clause per group and measure.
template <class Wanted, class Tell>
Texts clauses(const Groups& groups, const Wanted& wanted, const Tell& tell) {
    Texts parts;
    for (const GroupFindings& group : groups) {
        Texts of_group;
        for (const Metric metric : kAnswered) {
            const auto found = chosen(group, metric, wanted);
            if (!found.empty()) of_group.push_back(tell(found));
        }
        if (!of_group.empty()) parts.push_back(fmt::format("at {} {}", group.name, list_text(of_group)));
    }
    return parts;
}

bool any_comparison(const Groups& groups, bool (*wanted)(const ConditionPair&)) {
    return std::any_of(groups.begin(), groups.end(), [&](const GroupFindings& group) {
        return std::any_of(group.comparisons.begin(), group.comparisons.end(), wanted);
    });
}

bool anything(const ConditionPair&) { return true; }
bool measured(const ConditionPair& c) { return c.shift.has_value(); }
bool judged(const ConditionPair& c) { return c.can_be_judged(); }
bool told_apart(const ConditionPair& c) { return c.apart(); }

std::string difference_sentence(const Groups& groups) {
    const Texts apart = clauses(groups, told_apart, apart_text);
    if (!apart.empty()) return sentence(fmt::format("{}", fmt::join(apart, "; ")));
    if (any_comparison(groups, told_apart))
        return "Modalities differ only in mean penetration; the table shows by how much.";
    if (any_comparison(groups, judged))
        return "No difference between two modalities was found in any measure.";
    if (!any_comparison(groups, anything))
        return "No two modalities can be compared: no delay has measures of two modalities.";
    const Texts seen = clauses(groups, measured, [](const std::vector<const ConditionPair*>& all) {
        const ConditionPair& c = largest(all);
        return fmt::format("{} in {}", difference_text(c), name_of(c.metric));
    });
    if (seen.empty()) return "No subject has measures of two modalities, so nothing can be compared.";
    return sentence(fmt::format("the largest differences seen: {}", fmt::join(seen, "; ")));
}

// ---- what cannot be said

std::string pairs_text(const std::vector<const ConditionPair*>& comparisons) {
    Texts pairs;
    for (const ConditionPair* c : comparisons)
        pairs.push_back(fmt::format("{} - {} ({})", c->first, c->second, interval_text(*c)));
    return fmt::format("{} {}", name_of(comparisons[0]->metric), list_text(pairs));
}

std::string count_text(const std::vector<const ConditionPair*>& comparisons) {
    return fmt::format("{} of {} in {}", comparisons.size(), counted(comparisons[0]->family, "pair"),
                       name_of(comparisons[0]->metric));
}

bool alike(const ConditionPair& c) { return c.can_be_judged() && !c.apart(); }

// Each with its interval, or, where they are many, how many.
std::string alike_text(const Groups& groups) {
    std::size_t pairs = 0;
    for (const GroupFindings& group : groups) {
        for (const Metric metric : kAnswered) pairs += chosen(group, metric, alike).size();
    }
    if (pairs == 0) return "";
    if (pairs > kMostListed)
        return fmt::format(
            "no difference was found in these pairs, which does not mean that they are equal: {} (the tables "
            "show the intervals)",
            fmt::join(clauses(groups, alike, count_text), "; "));
    return fmt::format(
        "no difference was found in these pairs, which does not mean that they are equal (95 % intervals): "
        "{}",
        fmt::join(clauses(groups, alike, pairs_text), "; "));
}

std::string need_text(const ConditionPair& c) {
    if (!c.paired)
        return fmt::format("{} of two modalities are too few for a test, which needs at least {} of each",
                           counted(c.n, "trial"), counted(c.fewest(), "trial"));
    return fmt::format("{} {} too few for a test between modalities, which needs at least {}",
                       counted(c.n, "subject"), c.n == 1 ? "is" : "are", counted(c.fewest(), "subject"));
}

// The first of each group; groups that lack the same are named together.
Texts too_few(const Groups& groups) {
    std::vector<std::pair<std::string, Texts>> needs;
    for (const GroupFindings& group : groups) {
        const auto& all = group.comparisons;
        const auto few =
            std::find_if(all.begin(), all.end(), [](const auto& c) { return !c.can_be_judged(); });
        if (few == all.end()) continue;
        const std::string need = need_text(*few);
        const auto known =
            std::find_if(needs.begin(), needs.end(), [&](const auto& other) { return other.first == need; });
        (known == needs.end() ? needs.emplace_back(need, Texts{}) : *known).second.push_back(group.name);
    }
    Texts parts;
    for (const auto& [need, names] : needs)
        parts.push_back(fmt::format("{} (at {})", need, list_text(names)));
    return parts;
}

std::string limits_sentence(const Groups& groups) {
    Texts parts = too_few(groups);
    if (std::string text = alike_text(groups); !text.empty()) parts.push_back(std::move(text));
    for (const GroupFindings& group : groups) {
        for (const auto& [condition, metric] : group.unmeasured)
            parts.push_back(fmt::format("{} has no {} at {}", condition, name_of(metric), group.name));
    }
    if (!parts.empty()) return sentence(fmt::format("{}", fmt::join(parts, "; ")));
    return fmt::format(
        "{}he results do not tell about other hands, tissues or delays.",
        any_comparison(groups, anything) && !any_comparison(groups, alike) ? "Every pair differs; t" : "T");
}

// The same trials without delay only show that it is the delay: the tables compare them.
Groups without_controls(Groups groups) {
    const auto delayed = [](const GroupFindings& group) { return group.delay_s > 0; };
    std::set<std::uint32_t> experiments;
    for (const GroupFindings& group : groups) {
        if (delayed(group)) experiments.insert(group.experiment);
    }
    std::erase_if(groups, [&](const GroupFindings& group) {
        return !delayed(group) && experiments.contains(group.experiment);
    });
    return groups;
}

}  // namespace

std::vector<std::string> answer(const std::vector<GroupFindings>& groups) {
    const Groups compared = without_controls(groups);
    return {oscillation_sentence(groups), difference_sentence(compared), limits_sentence(compared)};
}

}  // namespace thimble
