#include "visual_node/window/pointer_hand.hpp"

#include <algorithm>
#include <cmath>

namespace thimble {

void PointerHand::move(double counts) { shift(counts * m_per_count_); }

void PointerHand::push(double deflection, Duration time) {
    if (!(std::abs(deflection) > kStickDeadBand)) return;
    shift(std::clamp(deflection, -1.0, 1.0) * kStickSpeed_m_per_s * to_seconds(time));
}

void PointerHand::shift(double way_m) {
    if (!engaged_ || !std::isfinite(way_m)) return;
    // The other thread may send it home meanwhile, which must not be undone.
    double from_m = position_hand_m_;
    while (!position_hand_m_.compare_exchange_weak(from_m, std::clamp(from_m + way_m, -kReach_m, kReach_m))) {
    }
}

}  // namespace thimble
