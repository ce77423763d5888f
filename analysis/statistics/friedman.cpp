#include "analysis/statistics/friedman.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

#include "analysis/statistics/distributions.hpp"

namespace thimble {
namespace {

constexpr const char* kFriedman = "Friedman test";

// Everything in doubled ranks, so that it is whole and exact.
struct RankedTable {
    std::vector<std::vector<std::int64_t>> rows;
    std::vector<std::int64_t> sums;    // per condition
    std::int64_t spread_of_sums = 0;   // sum_j (R_j - n (k + 1))^2
    std::int64_t spread_of_ranks = 0;  // sum_ij (r_ij - (k + 1))^2
};

RankedTable rank(const SampleTable& table) {
    const auto k = static_cast<std::int64_t>(table.conditions());
    const auto n = static_cast<std::int64_t>(table.subjects());
    RankedTable ranked;
    ranked.sums.assign(table.conditions(), 0);
    for (std::size_t s = 0; s < table.subjects(); ++s) {
        ranked.rows.push_back(doubled_ranks(table.row(s)));
        for (std::size_t c = 0; c < table.conditions(); ++c) {
            const std::int64_t rank = ranked.rows.back()[c];
            ranked.sums[c] += rank;
            ranked.spread_of_ranks += (rank - (k + 1)) * (rank - (k + 1));
        }
    }
    for (const std::int64_t sum : ranked.sums) {
        ranked.spread_of_sums += (sum - n * (k + 1)) * (sum - n * (k + 1));
    }
    return ranked;
}

RankedTable checked_ranks(const SampleTable& table) {
    table.require_shape(2, 2, kFriedman);
    RankedTable ranked = rank(table);
    if (ranked.spread_of_ranks == 0) {
        refuse(kFriedman, "every subject has the same value in all columns ('" + table.name(0) +
                              "' ...), so there is no order to test; check where the values come from");
    }
    return ranked;
}

std::vector<double> mean_ranks(const RankedTable& ranked) {
    std::vector<double> means;
    for (const std::int64_t sum : ranked.sums) {
        means.push_back(static_cast<double>(sum) / static_cast<double>(2 * ranked.rows.size()));
    }
    return means;
}

// Outcomes gathered before equal ones are merged: bounds the memory to about 32 MB, or twice the states.
constexpr std::size_t kMergeAt = 1'000'000;

using Ranks = std::vector<std::int64_t>;
// Sorted column sums, packed, and their probability.
using State = std::pair<std::uint64_t, double>;

// All columns but the last, whose sum follows from the others.
class Packing {
  public:
    // Sums stay below 2 n k + 1.
    Packing(std::size_t subjects, std::size_t conditions)
        : conditions_(conditions), bits_(std::bit_width(2 * subjects * conditions)) {}

    bool fits() const { return bits_ * (conditions_ - 1) <= 64; }

    std::uint64_t pack(const Ranks& sums) const {
        std::uint64_t key = 0;
        for (std::size_t c = 0; c + 1 < conditions_; ++c)
            key = key << bits_ | static_cast<std::uint64_t>(sums[c]);
        return key;
    }

    void unpack(std::uint64_t key, std::int64_t total, Ranks& sums) const {
        const std::uint64_t mask = (std::uint64_t{1} << bits_) - 1;
        std::int64_t rest = total;
        for (std::size_t c = conditions_ - 1; c-- > 0;) {
            sums[c] = static_cast<std::int64_t>(key & mask);
            rest -= sums[c];
            key >>= bits_;
        }
        sums[conditions_ - 1] = rest;
    }

  private:
    std::size_t conditions_;
    std::size_t bits_;
};

// Equal states become one. Sorted by probability too, so that the sum's rounding does not depend on how the
// library sorts.
void merge(std::vector<State>& states) {
    std::sort(states.begin(), states.end());
    std::size_t last = 0;
    for (std::size_t i = 1; i < states.size(); ++i) {
        if (states[i].first == states[last].first) {
            states[last].second += states[i].second;
        } else {
            states[++last] = states[i];
        }
    }
    states.resize(last + 1);
}

// Of a sorted row, k! / product of (ties!); no longer exact once it is beyond `most`.
std::size_t count_arrangements(const Ranks& row, std::size_t most) {
    std::size_t count = 1, ties = 0;
    for (std::size_t i = 0; i < row.size() && count <= most; ++i) {
        ties = i > 0 && row[i] == row[i - 1] ? ties + 1 : 1;
        count = count * (i + 1) / ties;
    }
    return count;
}

// Each arrangement is added to one state at least. Counted before any of them takes memory.
bool too_many_arrangements(const std::vector<Ranks>& rows, std::size_t most_steps) {
    std::size_t sum = 0;
    for (const Ranks& row : rows) {
        sum += count_arrangements(row, most_steps);
        if (sum > most_steps) return true;
    }
    return false;
}

std::optional<std::vector<Ranks>> arrangements(Ranks row, std::size_t most) {
    std::sort(row.begin(), row.end());
    std::vector<Ranks> all;
    do {
        if (all.size() == most) return std::nullopt;
        all.push_back(row);
    } while (std::next_permutation(row.begin(), row.end()));
    return all;
}

class ExactNull {
  public:
    ExactNull(std::size_t subjects, std::size_t conditions, std::size_t most_steps)
        : packing_(subjects, conditions),
          sums_(conditions),
          per_row_(static_cast<std::int64_t>(conditions * (conditions + 1))),
          steps_left_(most_steps) {
        states_.push_back({packing_.pack(sums_), 1.0});
    }

    bool fits() const { return packing_.fits(); }

    // One more subject. False if there are too few steps left.
    bool add(const Ranks& row) {
        if (row != row_) {
            auto all = arrangements(row, steps_left_);
            if (!all) return false;
            arrangements_ = std::move(*all);
            row_ = row;
        }
        if (states_.size() > steps_left_ / arrangements_.size()) return false;
        steps_left_ -= states_.size() * arrangements_.size();
        std::vector<State> next;
        std::size_t merge_at = kMergeAt;
        each_outcome([&](Ranks& sums, double p) {
            std::sort(sums.begin(), sums.end());
            next.push_back({packing_.pack(sums), p});
            if (next.size() < merge_at) return;
            merge(next);
            merge_at = std::max(kMergeAt, 2 * next.size());
        });
        merge(next);
        states_ = std::move(next);
        total_ += per_row_;
        return true;
    }

    double tail(std::int64_t spread) {
        const auto conditions = static_cast<std::int64_t>(sums_.size());
        double p = 0;
        for (const auto& [key, probability] : states_) {
            packing_.unpack(key, total_, sums_);
            std::int64_t squares = 0;
            for (const std::int64_t sum : sums_) {
                const std::int64_t deviation = sum - total_ / conditions;
                squares += deviation * deviation;
            }
            if (squares >= spread) p += probability;
        }
        return std::min(p, 1.0);
    }

  private:
    template <class Visit>
    void each_outcome(const Visit& visit) {
        const auto ways = static_cast<double>(arrangements_.size());
        Ranks outcome(sums_.size());
        for (const auto& [key, probability] : states_) {
            packing_.unpack(key, total_, sums_);
            for (const Ranks& arrangement : arrangements_) {
                for (std::size_t c = 0; c < outcome.size(); ++c) outcome[c] = sums_[c] + arrangement[c];
                visit(outcome, probability / ways);
            }
        }
    }

    Packing packing_;
    std::vector<State> states_;
    std::vector<Ranks> arrangements_;
    Ranks row_;
    Ranks sums_;
    std::int64_t per_row_;    // a row of doubled ranks adds up to k (k + 1)
    std::int64_t total_ = 0;  // of all rows added
    std::size_t steps_left_;
};

}  // namespace

std::vector<std::int64_t> doubled_ranks(std::span<const double> values) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
    std::vector<std::int64_t> ranks(values.size());
    for (std::size_t first = 0, last = 0; first < order.size(); first = last) {
        while (last < order.size() && values[order[last]] == values[order[first]]) ++last;
        // Mean of the ranks first + 1 to last.
        for (std::size_t i = first; i < last; ++i)
            ranks[order[i]] = static_cast<std::int64_t>(first + 1 + last);
    }
    return ranks;
}

Friedman friedman(const SampleTable& table) {
    const RankedTable ranked = checked_ranks(table);
    Friedman result;
    result.df = static_cast<double>(table.conditions() - 1);
    result.chi_squared =
        result.df * static_cast<double>(ranked.spread_of_sums) / static_cast<double>(ranked.spread_of_ranks);
    result.p_asymptotic = chi_squared_upper(result.chi_squared, result.df);
    result.p_exact = friedman_exact_p(ranked.rows, ranked.spread_of_sums, kFriedmanExactSteps);
    result.kendalls_w = result.chi_squared / (static_cast<double>(table.subjects()) * result.df);
    result.mean_ranks = mean_ranks(ranked);
    return result;
}

std::vector<DunnPair> dunn_after_friedman(const SampleTable& table) {
    const std::vector<double> means = mean_ranks(checked_ranks(table));
    const auto k = static_cast<double>(means.size());
    const double standard_error = std::sqrt(k * (k + 1) / (6 * static_cast<double>(table.subjects())));
    const double family = k * (k - 1) / 2;
    std::vector<DunnPair> pairs;
    for (std::size_t first = 0; first + 1 < means.size(); ++first) {
        for (std::size_t second = first + 1; second < means.size(); ++second) {
            DunnPair pair{first, second, means[first] - means[second]};
            pair.z = std::abs(pair.mean_rank_difference) / standard_error;
            pair.p = normal_two_sided(pair.z);
            pair.p_adjusted = std::min(1.0, family * pair.p);
            pairs.push_back(pair);
        }
    }
    return pairs;
}

std::optional<double> friedman_exact_p(const std::vector<Ranks>& rows, std::int64_t spread,
                                       std::size_t most_steps) {
    // In one order, whatever that of the subjects: the same bits, and equal rows share their arrangements.
    std::vector<Ranks> sorted = rows;
    for (Ranks& row : sorted) std::sort(row.begin(), row.end());
    std::sort(sorted.begin(), sorted.end());
    ExactNull null(sorted.size(), sorted.front().size(), most_steps);
    if (!null.fits() || too_many_arrangements(sorted, most_steps)) return std::nullopt;
    for (const Ranks& row : sorted) {
        if (!null.add(row)) return std::nullopt;
    }
    return null.tail(spread);
}

}  // namespace thimble
