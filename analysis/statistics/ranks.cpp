#include "analysis/statistics/ranks.hpp"

#include <algorithm>
#include <numeric>

namespace thimble {
namespace {

// Calls visit(first, last, order) for each run of equal values in sorted order.
template <class Visit>
void each_tie(std::span<const double> values, const Visit& visit) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
    for (std::size_t first = 0, last = 0; first < order.size(); first = last) {
        while (last < order.size() && values[order[last]] == values[order[first]]) ++last;
        visit(first, last, order);
    }
}

}  // namespace

std::vector<std::int64_t> doubled_ranks(std::span<const double> values) {
    std::vector<std::int64_t> ranks(values.size());
    each_tie(values, [&](std::size_t first, std::size_t last, const std::vector<std::size_t>& order) {
        // Mean of the ranks first + 1 to last.
        for (std::size_t i = first; i < last; ++i)
            ranks[order[i]] = static_cast<std::int64_t>(first + 1 + last);
    });
    return ranks;
}

double tie_correction(std::span<const double> values) {
    double sum = 0;
    each_tie(values, [&](std::size_t first, std::size_t last, const std::vector<std::size_t>&) {
        const auto t = static_cast<double>(last - first);
        sum += t * t * t - t;
    });
    return sum;
}

}  // namespace thimble
