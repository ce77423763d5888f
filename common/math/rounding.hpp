// The test that ends the fast way: is it sure to which double a result is to be rounded?
#pragma once

#include <cmath>

#include "common/math/double_double.hpp"

namespace thimble {

// `exactly()` decides where `result`, with a relative error below 2^-85, leaves it open; also below the normal doubles, which have fewer bits.
template <class Exactly>
double rounded(DoubleDouble result, Exactly exactly) {
    constexpr double kRelativeError = 0x1p-85, kLeastNormal = 0x1p-1000;
    const double error = std::abs(result.high) * kRelativeError;
    const double upper = result.high + (result.low + error), lower = result.high + (result.low - error);
    return upper == lower && std::abs(upper) > kLeastNormal ? upper : exactly();
}

}  // namespace thimble
