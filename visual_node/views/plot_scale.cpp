#include "visual_node/views/plot_scale.hpp"

#include <cassert>
#include <cmath>
#include <initializer_list>

namespace thimble {
namespace {

PlotScale around(double low, double high, double step) {
    return {std::floor(low / step) * step, std::ceil(high / step) * step, step};
}

}  // namespace

PlotScale round_scale(double low, double high, double span, int lines) {
    assert(span > 0 && lines >= 1);
    if (low > high) low = high = 0;
    if (high - low < span) high = low + span;
    // Rounding outwards adds up to two steps, so the first power to try is one that is too fine.
    double power = std::pow(10, std::floor(std::log10((high - low) / lines)));
    for (;; power *= 10) {
        for (const double factor : {1.0, 2.0, 5.0}) {
            const PlotScale scale = around(low, high, factor * power);
            if (std::lround((scale.high - scale.low) / scale.step) <= lines + 1) return scale;
        }
    }
}

}  // namespace thimble
