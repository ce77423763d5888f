// Two one-sided tests of the same subjects under two conditions: is their difference certainly smaller than what would
// matter? Schuirmann, "A comparison of the two one-sided tests procedure and the power approach ...", J. Pharmacokinetics
// and Biopharmaceutics 15(6), 1987.
#pragma once

#include "analysis/statistics/named_values.hpp"

namespace thimble {

// The largest difference that counts as none, first minus second, in the data's unit. State it before looking.
struct EquivalenceBounds {
    double low = 0;
    double high = 0;
};

struct Equivalence {
    double difference = 0;  // mean of the first minus mean of the second, data's unit
    double df = 0;          // n - 1
    double t_low = 0;       // (difference - bounds.low) / standard error
    double t_high = 0;      // (difference - bounds.high) / standard error
    double p_low = 1;       // against a difference <= bounds.low: P(T >= t_low)
    double p_high = 1;      // against a difference >= bounds.high: P(T <= t_high)
    // At 1 - 2 alpha (90 % at alpha = .05): inside the bounds exactly if p() < alpha.
    ConfidenceInterval interval;

    double p() const { return p_low > p_high ? p_low : p_high; }  // both must be refuted: the larger decides
};

// At least 2 subjects, value s of each column being subject s; low < high, alpha in (0, 0.5). Throws Error
// (kData) otherwise, for missing values, and where the columns differ by the same amount in every subject.
Equivalence equivalence(const NamedValues& first, const NamedValues& second, EquivalenceBounds bounds,
                        double alpha = 0.05);

}  // namespace thimble
