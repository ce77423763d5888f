// From values to pixels, with round numbers at the grid lines.
#pragma once

namespace thimble {

// [low, high] are multiples of step, which is 1, 2 or 5 times a power of ten.
struct PlotScale {
    double low = 0, high = 1, step = 1;

    // 0 at low, 1 at high; beyond them beyond.
    double fraction(double value) const { return (value - low) / (high - low); }
};

// The tightest scale that holds both values and at least `span` with at most `lines` + 1 steps. `low` > `high` (nothing was
// seen): [0, span]. `span` > 0, `lines` >= 1.
PlotScale round_scale(double low, double high, double span, int lines);

}  // namespace thimble
