// The force loop of a session, computed from its settings: hand, handle, fixture, and the delays that they bear.
#pragma once

#include <array>

#include "common/messages.hpp"
#include "session/settings/system_settings.hpp"
#include "stability/critical_delay.hpp"

namespace thimble {

struct LoopLimits {
    double critical_delay_s = 0;  // of HF; infinite: no delay is too long
    double sample_period_s = 0;
    std::array<double, kModalities.size()> latency_s{};  // own, of CF, CCF, VF; by Modality
    double needle_held_s = 0;                            // after so long a pause the needle is held
    double released_s = 0;                               // and the displays let go
    double configured_s = 0;                             // of the session's own network, there and back
    double late_s = 0;  // a force at the handle that needs so much longer counts as none
};
// Nominal operator, no co-contraction; the fixture's stiffness as the scene has it.
LoopLimits loop_limits(const SystemSettings& settings);
// The session's handle in the nominal hand, no co-contraction.
HeldHandle held_handle(const SystemSettings& settings);
// Of the first forbidden region, per metre of needle; 0 without one.
double fixture_stiffness_N_per_m(const SlaveSettings& settings);

}  // namespace thimble
