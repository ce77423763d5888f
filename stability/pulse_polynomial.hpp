// The characteristic polynomial of a sampled loop. Inside this room's sources only.
#pragma once

#include "stability/circle_count.hpp"
#include "stability/sampled_loop.hpp"

namespace thimble {

// Throws Error (usage) for what is no sampled loop.
PulsePolynomial<Precise> pulse_polynomial(const SampledLoop& loop);

// T = count h + rest, where a rest within the rounding of T / h is none. Checks like pulse_polynomial.
struct WholeSteps {
    double count;
    Precise rest_s;
};
WholeSteps whole_steps(const SampledLoop& loop);

PulsePolynomial<double> in_doubles(const PulsePolynomial<Precise>& p);

}  // namespace thimble
