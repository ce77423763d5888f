#include "study/fit/fit_summary.hpp"

#include <vector>

#include "analysis/statistics/descriptive.hpp"
#include "common/math/portable.hpp"

namespace thimble {
namespace {

// Of the standard normal distribution: 90 % lie within.
constexpr double kNinety = 1.6448536269514722;

}  // namespace

KeySummary summarise(const FittedKey& key, std::span<const TraitScores> draws) {
    NamedValues values{key.key, {}}, logarithms{key.key, {}};
    for (const TraitScores& scores : draws) {
        values.values.push_back(key.value(scores));
        logarithms.values.push_back(portable::log(values.values.back()));
    }
    const double spread = key.spread_of_logarithm();
    return {key.key,
            sample_quantile(values, 0.5),
            sample_quantile(values, 0.05),
            sample_quantile(values, 0.95),
            key.median * portable::exp(-kNinety * spread),
            key.median * portable::exp(kNinety * spread),
            1 - sample_sd(logarithms) / spread};
}

}  // namespace thimble
