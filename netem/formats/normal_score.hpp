// The standard normal distribution and its inverse, as far as fits need them.
#pragma once

#include <cmath>
#include <numbers>

namespace thimble {

// Share of a standard normal variable below z.
inline double normal_share(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

// The z below which a share in (0, 1) lies, by bisection: to 1e-12, within [-9, 9].
inline double normal_score(double share) {
    double low = -9, high = 9;
    for (int i = 0; i < 44; ++i) {
        const double middle = (low + high) / 2;
        (normal_share(middle) < share ? low : high) = middle;
    }
    return (low + high) / 2;
}

}  // namespace thimble
