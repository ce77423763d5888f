#include "study/board/pareto.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "analysis/statistics/descriptive.hpp"

namespace thimble {
namespace {

// The least share of trials that oscillated or did not complete: a row does not say which trials did both.
BoardValue unstable_share(const std::vector<const BoardRow*>& rows) {
    double bad = 0;
    std::size_t trials = 0;
    for (const BoardRow* const row : rows) {
        bad += row->trials * std::max(row->values[kOscillating].mean, row->values[kNotCompleted].mean);
        trials += row->trials;
    }
    if (trials == 0) return {};
    const auto interval =
        wilson_interval(static_cast<std::size_t>(std::lround(bad)), trials, kBoardConfidence);
    return {bad / static_cast<double>(trials), interval.low, interval.high};
}

// The mean over rows. Half widths of independent means add up by their squares.
BoardValue mean_over(const std::vector<const BoardRow*>& rows, BoardMeasure measure) {
    double sum = 0, below = 0, above = 0, count = 0;
    for (const BoardRow* const row : rows) {
        BoardValue value = row->values[measure];
        if (!std::isfinite(value.mean) && measure == kStiffnessFelt) value = {0, 0, 0};  // none was felt
        if (!std::isfinite(value.mean)) continue;
        sum += value.mean;
        below += (value.mean - value.low) * (value.mean - value.low);
        above += (value.high - value.mean) * (value.high - value.mean);
        ++count;
    }
    if (count == 0) return {};
    return {sum / count, (sum - std::sqrt(below)) / count, (sum + std::sqrt(above)) / count};
}

Contestant contestant_of(const std::string& name, const std::vector<const BoardRow*>& all) {
    Contestant contestant;
    contestant.name = name;
    contestant.rows = all.size();
    std::vector<const BoardRow*> rows;
    for (const BoardRow* const row : all) {
        if (row->status == "ok") rows.push_back(row);
        if (row->stable()) ++contestant.stable_rows;
    }
    contestant.failed_rows = all.size() - rows.size();
    contestant.values = {unstable_share(rows), mean_over(rows, kPenetrationMax),
                         mean_over(rows, kStiffnessFelt), mean_over(rows, kDrift), mean_over(rows, kPackets)};
    return contestant;
}

// The first front, then that of the others, and so on.
void number_fronts(std::vector<Contestant>& contestants) {
    std::vector<Contestant*> left;
    for (Contestant& one : contestants)
        if (one.failed_rows == 0) left.push_back(&one);
    for (std::size_t front = 1; !left.empty(); ++front) {
        std::vector<Contestant*> best, rest;
        for (Contestant* const one : left) {
            const bool beaten = std::any_of(
                left.begin(), left.end(), [one](const Contestant* other) { return dominates(*other, *one); });
            (beaten ? rest : best).push_back(one);
        }
        if (best.empty()) best.swap(rest);  // intervals may make a ring
        for (Contestant* const one : best) one->front = front;
        left = rest;
    }
}

}  // namespace

bool is_better(const BoardValue& a, const BoardValue& b, Objective objective) {
    const ObjectiveRule& rule = kObjectiveRules[objective];
    const double by = rule.more ? a.mean - b.mean : b.mean - a.mean;
    return by > rule.least && (rule.more ? a.low > b.high : a.high < b.low);
}

bool dominates(const Contestant& a, const Contestant& b) {
    bool better = false;
    for (std::size_t i = 0; i < kObjectives; ++i) {
        const auto objective = static_cast<Objective>(i);
        if (is_better(b.values[i], a.values[i], objective)) return false;
        better = better || is_better(a.values[i], b.values[i], objective);
    }
    return better;
}

std::vector<Contestant> rank_contestants(const std::vector<BoardRow>& rows) {
    std::set<std::string> codecs;
    for (const BoardRow& row : rows) codecs.insert(row.codec);
    std::vector<std::string> order;
    std::map<std::string, std::vector<const BoardRow*>> by_name;
    for (const BoardRow& row : rows) {
        const std::string name = codecs.size() > 1 ? row.controller + " / " + row.codec : row.controller;
        if (by_name[name].empty()) order.push_back(name);
        by_name[name].push_back(&row);
    }
    std::vector<Contestant> contestants;
    contestants.reserve(order.size());
    for (const std::string& name : order) contestants.push_back(contestant_of(name, by_name[name]));
    for (Contestant& one : contestants) {
        for (const Contestant& other : contestants)
            if (one.failed_rows == 0 && other.failed_rows == 0 && dominates(other, one))
                one.dominated_by.push_back(other.name);
    }
    number_fronts(contestants);
    return contestants;
}

}  // namespace thimble
