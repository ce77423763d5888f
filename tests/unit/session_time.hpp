#pragma once

#include "common/time.hpp"

namespace thimble {

constexpr SessionTime at(Duration since_start) { return SessionTime{since_start}; }

}  // namespace thimble
