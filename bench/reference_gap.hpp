// Event isolation for the reference: halving with rigorous bounds on the derivatives of the gap.
#pragma once

#include <optional>

#include "bench/reference_motion.hpp"

namespace thimble {

// side * (needle - surface): +1 asks for a needle that enters, -1 for one that leaves.
struct ReferenceGap {
    int side;
    ReferenceNumber needle_m;  // at the start of the leg
    ReferenceNumber velocity_needle_m_per_s;
    ReferenceLaw law;
};

struct ReferenceCrossing {
    ReferenceNumber after_s;
    ReferenceMotion motion;
};

// The first rise of the gap above zero within (0, T], or at 0 if it stands at zero and rises at once. A gap at
// zero that falls or rests is no crossing, nor is one that reaches zero with the very end of the leg.
std::optional<ReferenceCrossing> first_crossing(const ReferenceGap& gap, const ReferenceMotion& start,
                                                ReferenceHalving& halving);

}  // namespace thimble
