// The number in which reference solutions are computed.
#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>

namespace thimble {

// 100 digits, of which a massless surface costs some 25 (its fast mode is 1e10 times shorter than a step)
// and halving down to an event 50 more where it touches; 40 are wanted.
using ReferenceNumber =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<100>, boost::multiprecision::et_off>;

}  // namespace thimble
