#include "study/loop_limits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "slave_sim/needle_scene.hpp"

namespace thimble {

constexpr double kFrameWaits = 0.5;  // of a frame, on average, until it is drawn

HeldHandle held_handle(const SystemSettings& s) {
    const HandMechanics& hand = s.person.hand;
    const HandleMechanics& handle = s.handle.mechanics;
    const double m_d = handle.moving_mass_kg, k_g = hand.grip_stiffness_N_per_m;
    const double m_a = hand.arm_mass_kg, k_a = hand.arm_stiffness_N_per_m;
    return {m_d, handle.damping_Ns_per_m,
            k_g, 2 * hand.grip_damping_ratio * std::sqrt(k_g * m_d),
            m_a, 2 * hand.arm_damping_ratio * std::sqrt(k_a * (m_a + m_d)),
            k_a};
}

// Not measured by a press: an event of the trial may move or remove the region.
double fixture_stiffness_N_per_m(const SlaveSettings& settings) {
    const NeedleScene scene(settings.scene, settings.make_tissue);
    return scene.fixture() == nullptr ? 0 : scene.fixture()->stiffness_N_per_m();
}

LoopLimits loop_limits(const SystemSettings& s) {
    LoopLimits limits;
    const double stiffness =
        s.master.position_scale * s.master.force_scale * fixture_stiffness_N_per_m(s.slave);
    limits.critical_delay_s =
        stiffness > 0 ? critical_delay_s(held_handle(s), stiffness) : std::numeric_limits<double>::infinity();
    limits.sample_period_s = to_seconds(s.master.sample_period);
    const ReactionParameters& reaction = s.person.reaction;
    const double actuator_s = to_seconds(s.cutaneous.dead_time + s.cutaneous.time_constant);
    const double screen_s = kFrameWaits / s.visual.refresh_Hz + to_seconds(s.visual.pipeline);
    const auto set = [&](Modality modality, double latency_s) {
        limits.latency_s[static_cast<std::size_t>(modality)] = latency_s;
    };
    set(Modality::kCF, actuator_s + reaction.cutaneous_s);
    set(Modality::kCCF, actuator_s + reaction.tactile_s + reaction.crossing_s + reaction.compatibility_s);
    set(Modality::kVF, screen_s + reaction.visual_s);
    limits.needle_held_s = to_seconds(s.slave.stale_after);
    limits.released_s =
        to_seconds(std::min({s.master.stale.after, s.cutaneous.stale.after, s.visual.stale.after}));
    limits.configured_s = to_seconds(session_settings(s).network_delay);
    limits.late_s = to_seconds(s.master.stale.after) +
                    std::max(0.0, to_seconds(s.master.oldest_force) - limits.configured_s);
    return limits;
}

}  // namespace thimble
