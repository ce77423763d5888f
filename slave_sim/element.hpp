// A part of a scene: anything that pushes on the needle.
//
// One axis z, positive into the tissue; SI units; forces act on the operator, negative resists insertion.
// Between two samples the needle moves on a straight line, so its velocity is constant within a step and
// jumps between steps. An element's values after a step are left limits, with the velocity of that step.
#pragma once

#include <limits>

#include "slave_sim/transitions.hpp"

namespace thimble {

struct NeedleStep {
    double start_s = 0;     // on the scene's clock
    double duration_s = 0;  // > 0
    double from_m = 0;
    double to_m = 0;
    // Slope of the line; for an element that follows an encoder's reading, the estimated velocity.
    double velocity_m_per_s = 0;
};

class Element {
  public:
    virtual ~Element() = default;

    // The beginning of a trial, with the needle at rest here.
    virtual void reset(double position_needle_m) = 0;
    // Moves the needle and reports what changed on the way. An element that was skipped because it rested
    // sees only the steps that reach it: `from_m` says where the needle is.
    virtual void step(const NeedleStep& step, Transitions& transitions) = 0;
    virtual double force_N() const = 0;
    // The element rests, unchanged and without cost, while the needle stays at or above this position. Minus
    // infinity: it never rests.
    virtual double rests_above_m() const { return -std::numeric_limits<double>::infinity(); }
};

}  // namespace thimble
