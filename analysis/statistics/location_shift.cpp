#include "analysis/statistics/location_shift.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "analysis/statistics/distributions.hpp"

namespace thimble {
namespace {

// Every sum of one value of `a` and one of `b`, both ascending, without writing them down.
class Sums {
  public:
    Sums(std::vector<double> a, std::vector<double> b) : a_(std::move(a)), b_(std::move(b)) {
        std::sort(a_.begin(), a_.end());
        std::sort(b_.begin(), b_.end());
    }
    double lowest() const { return a_.front() + b_.front(); }
    double highest() const { return a_.back() + b_.back(); }

    // How many are `below(sum)`, which holds up to some sum and not beyond.
    template <class Below>
    std::size_t count(const Below& below) const {
        std::size_t of_b = b_.size(), sum = 0;
        for (const double value : a_) {
            while (of_b > 0 && !below(value + b_[of_b - 1])) --of_b;
            sum += of_b;
        }
        return sum;
    }
    std::span<const double> a() const { return a_; }

  private:
    std::vector<double> a_, b_;
};

// Averages of two differences each, every difference also with itself (Walsh averages).
class Averages {
  public:
    explicit Averages(const std::vector<double>& differences)
        : sums_(halves(differences), halves(differences)) {
        total_ = differences.size() * (differences.size() + 1) / 2;
    }
    std::size_t total() const { return total_; }
    double lowest() const { return sums_.lowest(); }
    double highest() const { return sums_.highest(); }

    template <class Below>
    std::size_t count(const Below& below) const {  // each pair of different ones is among the sums twice
        const auto itself = std::count_if(sums_.a().begin(), sums_.a().end(),
                                          [&](double half) { return below(half + half); });
        return (sums_.count(below) + static_cast<std::size_t>(itself)) / 2;
    }

  private:
    static std::vector<double> halves(std::vector<double> values) {
        for (double& value : values) value /= 2;
        return values;
    }
    Sums sums_;
    std::size_t total_;
};

// Differences of each value of one group and each of another.
class Differences {
  public:
    Differences(const std::vector<double>& first, const std::vector<double>& second)
        : sums_(first, negative(second)), total_(first.size() * second.size()) {}
    std::size_t total() const { return total_; }
    double lowest() const { return sums_.lowest(); }
    double highest() const { return sums_.highest(); }
    template <class Below>
    std::size_t count(const Below& below) const {
        return sums_.count(below);
    }

  private:
    static std::vector<double> negative(std::vector<double> values) {
        for (double& value : values) value = -value;
        return values;
    }
    Sums sums_;
    std::size_t total_;
};

// The k-th smallest, k from 1: halves the range until no double is left between its ends.
template <class Values>
double kth(const Values& values, std::size_t k) {
    double low = values.lowest(), high = values.highest();
    const auto reached = [&](double x) { return values.count([x](double v) { return v <= x; }) >= k; };
    if (reached(low)) return low;
    for (;;) {
        const double middle = low + (high - low) / 2;
        if (middle <= low || middle >= high) return high;
        (reached(middle) ? high : low) = middle;
    }
}

template <class Values>
double median(const Values& values) {
    const double lower = kth(values, (values.total() + 1) / 2);
    if (values.total() % 2 == 1) return lower;
    return lower + (kth(values, values.total() / 2 + 1) - lower) / 2;
}

// P(statistic <= t) without a difference, where the statistic is symmetric between 0 and `total`.
class NullDistribution {
  public:
    // Each of the ranks 1 to n is positive or not, like coins.
    static NullDistribution of_signed_ranks(std::size_t n) {
        const auto count = static_cast<double>(n);
        NullDistribution null(n * (n + 1) / 2, count * (count + 1) * (2 * count + 1) / 24);
        if (n > kSignedRankExact) return null;
        std::vector<double> p(null.total_ + 1, 0.0);
        p[0] = 1;
        for (std::size_t rank = 1; rank <= n; ++rank) {
            for (std::size_t sum = p.size(); sum-- > 0;)
                p[sum] = (p[sum] + (sum >= rank ? p[sum - rank] : 0)) / 2;
        }
        null.set(p, 1);
        return null;
    }

    // Every choice of `n` of n + m ranks is equally likely; the sum of the chosen, less the smallest possible.
    static NullDistribution of_rank_sums(std::size_t n, std::size_t m) {
        const auto pairs = static_cast<double>(n * m), all = static_cast<double>(n + m);
        NullDistribution null(n * m, pairs * (all + 1) / 12);
        if (n + m > kRankSumExact) return null;
        // ways[c][u]: choices of c values of the first group that exceed u pairs.
        std::vector<std::vector<double>> ways(n + 1, std::vector<double>(null.total_ + 1, 0.0));
        ways[0][0] = 1;
        for (std::size_t place = 0; place < n + m; ++place) {
            for (std::size_t c = std::min(n, place + 1); c > 0; --c) {
                const std::size_t beneath =
                    place - (c - 1);  // of the other group, if this is the c-th chosen
                for (std::size_t u = null.total_ + 1; u-- > beneath;) ways[c][u] += ways[c - 1][u - beneath];
            }
        }
        double choices = 0;
        for (const double count : ways[n]) choices += count;
        null.set(ways[n], choices);
        return null;
    }

    double two_sided(std::size_t t) const { return std::min(1.0, 2 * lower(t)); }

  private:
    NullDistribution(std::size_t total, double variance) : total_(total), sd_(std::sqrt(variance)) {}

    void set(const std::vector<double>& weights, double sum) {
        double below = 0;
        for (const double weight : weights) lower_.push_back((below += weight) / sum);
    }

    double lower(std::size_t t) const {
        if (!lower_.empty()) return lower_[t];
        const double z = (static_cast<double>(t) + 0.5 - static_cast<double>(total_) / 2) / sd_;
        const double tail = normal_two_sided(z) / 2;
        return z < 0 ? tail : 1 - tail;
    }

    std::size_t total_;
    double sd_;
    std::vector<double> lower_;  // empty: normal
};

// How many of the smallest statistics have a P below the level.
template <class P>
std::size_t significant(const P& p_of, std::size_t total, double level) {
    std::size_t low = 0, high = total / 2 + 1;
    while (low < high) {
        const std::size_t middle = (low + high) / 2;
        if (p_of(middle) < level) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

template <class Values>
LocationShift shift_of(const Values& values, const NullDistribution& null, std::size_t family, double level) {
    const std::size_t total = values.total();
    const std::size_t below = values.count([](double v) { return v < 0; });
    const std::size_t above = total - values.count([](double v) { return v <= 0; });
    LocationShift shift;
    shift.estimate = median(values);
    const auto p_of = [&](std::size_t t) {
        return std::min(1.0, static_cast<double>(family) * null.two_sided(t));
    };
    // An average of zero counts on both sides: the sign that speaks least against no difference.
    shift.p = p_of(total - std::max(above, below));
    shift.rank_biserial =
        (static_cast<double>(above) - static_cast<double>(below)) / static_cast<double>(total);
    const std::size_t k = significant(p_of, total, level);
    if (k > 0) shift.interval = ConfidenceInterval{kth(values, k), kth(values, total + 1 - k)};
    return shift;
}

void require(const NamedValues& values, std::size_t family, double level, std::string_view test) {
    require_numbers(values, test);
    require_at_least(values, 1, test);
    require_confidence(1 - level, test);
    if (family == 0) refuse(test, "a family of no comparisons; it is at least this one");
}

}  // namespace

LocationShift signed_rank(const NamedValues& differences, std::size_t family, double level) {
    require(differences, family, level, "signed-rank test");
    return shift_of(Averages(differences.values),
                    NullDistribution::of_signed_ranks(differences.values.size()), family, level);
}

LocationShift rank_sum(const NamedValues& first, const NamedValues& second, std::size_t family,
                       double level) {
    for (const NamedValues& group : {first, second}) require(group, family, level, "rank-sum test");
    return shift_of(Differences(first.values, second.values),
                    NullDistribution::of_rank_sums(first.values.size(), second.values.size()), family, level);
}

std::size_t fewest_for_signed_rank(std::size_t family, double level) {
    std::size_t n = 1;
    for (double p = 1; static_cast<double>(family) * p >= level; ++n) p /= 2;  // 2 / 2^n: all of one sign
    return n;
}

std::size_t fewest_for_rank_sum(std::size_t family, double level) {
    std::size_t n = 1;
    double p = 1;  // 2 / (2n choose n): no overlap
    for (; static_cast<double>(family) * p >= level; ++n) {
        const auto size = static_cast<double>(n);
        p *= (size + 1) / (2 * (2 * size + 1));
    }
    return n;
}

}  // namespace thimble
