// Wilson's score interval of a proportion, without continuity correction: Wilson, "Probable inference, the law
// of succession, and statistical inference", JASA 22, 1927. Sensible also at 0 and 1 and for few trials.
#pragma once

#include <cstddef>

#include "analysis/statistics/confidence_interval.hpp"

namespace thimble {

// Inside [0, 1]; starts at exactly 0 without a success and ends at exactly 1 without a failure. Throws Error
// (kData) for no trials and for more successes than trials.
ConfidenceInterval wilson_interval(std::size_t successes, std::size_t trials, double confidence = 0.95);

}  // namespace thimble
