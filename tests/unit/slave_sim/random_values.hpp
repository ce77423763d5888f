// Numbers for property tests, drawn evenly whatever size RapidCheck is at.
#pragma once

#include <cmath>

#include <rapidcheck.h>

namespace thimble {

inline double between(double low, double high) {
    return low + (high - low) * 1e-6 * *rc::gen::resize(100, rc::gen::inRange(0, 1000001));
}

inline double decade(double low, double high) { return std::pow(10.0, between(low, high)); }

}  // namespace thimble
