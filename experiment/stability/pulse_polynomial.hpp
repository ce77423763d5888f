// The characteristic polynomial of a sampled loop. Inside this room's sources only.
#pragma once

#include "experiment/stability/circle_count.hpp"
#include "experiment/stability/sampled_loop.hpp"

namespace thimble {

// Throws Error (usage) for what is no sampled loop.
PulsePolynomial<Precise> pulse_polynomial(const SampledLoop& loop);
PulsePolynomial<double> in_doubles(const PulsePolynomial<Precise>& p);

}  // namespace thimble
