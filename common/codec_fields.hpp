// The fields of each message in the order of the wire (messages.fbs), with the ranges of docs/protocol.md. A visitor gets each field
// by reference, so that writing and reading have one list. Of a double it also gets the range; of an enum the last value, or the
// first and the last; of a count the most.
#pragma once

#include <concepts>
#include <type_traits>

#include "common/messages.hpp"

namespace thimble {

struct NumberRange {
    double low, high;
};
// Far outside anything a needle does, far inside what arithmetic can hold.
inline constexpr NumberRange kPosition_m{-10, 10};
inline constexpr NumberRange kVelocity_m_per_s{-1000, 1000};
inline constexpr NumberRange kForce_N{-1e5, 1e5};
inline constexpr NumberRange kForceSum_N{-2e5, 2e5};
inline constexpr NumberRange kShownForce_N{0, 1e5};
inline constexpr NumberRange kSpan_s{0, 1e6};
inline constexpr NumberRange kKnownSpan_s{-1, 1e6};  // negative: not known
inline constexpr NumberRange kEnergy_J{-1e6, 1e6};
inline constexpr NumberRange kWave_root_W{-1e6, 1e6};
inline constexpr NumberRange kWaveSum_root_W_s{-1e12, 1e12};
inline constexpr NumberRange kWaveEnergy_J{0, 1e12};

// `Message`, const for a visitor that only reads.
template <class Given, class Message>
concept Is = std::same_as<std::remove_const_t<Given>, Message>;

void visit_fields(auto& v, Is<Header> auto& m) {
    v(m.instance);
    v(m.send_time);
    v(m.sequence);
    v(m.trial);
    v(m.sender, Role::kExperimenter);
}

void visit_fields(auto& v, Is<NeedleCommand> auto& m) {
    v(m.position_needle_m, kPosition_m);
    v(m.velocity_needle_m_per_s, kVelocity_m_per_s);
    v(m.position_needle_estimate_m, kPosition_m);
    v(m.position_hand_m, kPosition_m);
    v(m.velocity_hand_m_per_s, kVelocity_m_per_s);
    v(m.force_hand_N, kForce_N);
}

void visit_fields(auto& v, Is<ForceFeedback> auto& m) {
    v(m.position_needle_m, kPosition_m);
    v(m.position_surface_m, kPosition_m);
    v(m.velocity_surface_m_per_s, kVelocity_m_per_s);
    v(m.position_proxy_m, kPosition_m);
    v(m.force_tissue_N, kForce_N);
    v(m.force_fixture_N, kForce_N);
    v(m.force_total_N, kForceSum_N);
    v(m.contact_time_s, kSpan_s);
    v(m.echo_time);
    v(m.hold_time);
    v(m.echo_sequence);
    v(m.phase, TissuePhase::kPenetrated);
    v(m.fixture_present);
    v(m.needle_held);
}

void visit_fields(auto& v, Is<Percept> auto& m) {
    v(m.force_N, kShownForce_N);
    v(m.bar_N, kShownForce_N);
    v(m.position_needle_shown_m, kPosition_m);
    v(m.position_surface_shown_m, kPosition_m);
    v(m.sample_age_s, kSpan_s);
    v(m.finger, Finger::kThumb);
    v(m.touching_shown);
    v(m.beep);
}

void visit_fields(auto& v, Is<SessionControl> auto& m) {
    v(m.study_seed);
    v(m.fixture_position_m, kPosition_m);
    v(m.network_delay_s, kSpan_s);
    v(m.silence_s, kSpan_s);
    v(m.network);
    v(m.subject);
    v(m.experiment);
    v(m.kind, ControlKind::kNetworkChange);
    v(m.modality, Modality::kVF);
    v(m.fixture_present);
    v(m.reason, kLastEndReason);
}

void visit_fields(auto& v, Is<Heartbeat> auto& m) {
    v(m.accepted);
    v(m.refused);
    v(m.round_trip_median_s, kSpan_s);
    v(m.round_trip_worst_s, kSpan_s);
    v(m.hold_median_s, kSpan_s);
    v(m.force_hand_N, kForce_N);
    v(m.energy_in_J, kEnergy_J);
    v(m.state, NodeState::kFailed);
    v(m.reason, kLastEndReason);
}

void visit_fields(auto& v, Is<ClockProbe> auto& m) { v(m.send_time); }

void visit_fields(auto& v, Is<ClockReply> auto& m) {
    v(m.probe_send_time);
    v(m.probe_arrival_time);
}

void visit_fields(auto& v, Is<HandInput> auto& m) {
    v(m.position_hand_m, kPosition_m);
    v(m.engaged);
}

void visit_fields(auto& v, Is<Monitor> auto& m) {
    v(m.time_s, kSpan_s);
    v(m.position_needle_m, kPosition_m);
    v(m.position_surface_m, kPosition_m);
    v(m.position_fixture_m, kPosition_m);
    v(m.force_tissue_N, kForce_N);
    v(m.force_fixture_N, kForce_N);
    v(m.force_total_N, kForceSum_N);
    v(m.contact_time_s, kSpan_s);
    v(m.force_hand_N, kForce_N);
    v(m.energy_in_J, kEnergy_J);
    v(m.round_trip_s, kSpan_s);
    v(m.one_way_s, kKnownSpan_s);
    v(m.one_way_bound_s, kSpan_s);
    v(m.network_delay_s, kSpan_s);
    v(m.network);
    v(m.accepted);
    v(m.refused);
    v(m.subject);
    v(m.trials);
    v(m.phase, TissuePhase::kPenetrated);
    v(m.modality, Modality::kVF);
    v(m.state, NodeState::kFailed);
    v(m.reason, kLastEndReason);
    v(m.fixture_present);
    v(m.needle_held);
    v(m.beeped);
    v(m.paused);
}

void visit_fields(auto& v, Is<Order> auto& m) {
    v(m.value, kSpan_s);
    v(m.network);
    v(m.trial);
    v(m.kind, OrderKind::kAnswer);
    v(m.modality, Modality::kVF);
}

void visit_fields(auto& v, Is<Page> auto& m) {
    v(m.remaining_s, kSpan_s);
    v(m.trial);
    v(m.trials);
    v(m.kind, PageKind::kQuestion);
}

void visit_fields(auto& v, Is<ReplayState> auto& m) {
    v(m.duration_s, kSpan_s);
    v(m.speed, kSpan_s);
    v(m.contact_s, kKnownSpan_s);
    v(m.beep_s, kKnownSpan_s);
    for (auto& time_s : m.change_s) v(time_s, kSpan_s);
    v(m.changes, std::uint32_t{ReplayState::kMostChanges});
}

void visit_fields(auto& v, Is<DeviceFault> auto& m) { v(m.text); }

void visit_fields(auto& v, Is<WaveBurst> auto& m) {
    for (auto& wave_root_W : m.wave_root_W) v(wave_root_W, kWave_root_W);
    v(m.sum_root_W_s, kWaveSum_root_W_s);
    v(m.energy_J, kWaveEnergy_J);
    v(m.number);
    v(m.count, std::uint32_t{WaveBurst::kMost});
}

void visit_fields(auto& v, Is<NeedleWave> auto& m) {
    visit_fields(v, m.command);
    visit_fields(v, m.waves);
}

void visit_fields(auto& v, Is<ForceWave> auto& m) {
    visit_fields(v, m.feedback);
    visit_fields(v, m.waves);
}

void visit_fields(auto& v, Is<StopOrder> auto& m) {
    v(m.id);
    v(m.held_ms);
    v(m.kind, StopKind::kAsk);
    v(m.reason, EndReason::kSafetyStop, EndReason::kEmergencyStop);
    v(m.text);
}

}  // namespace thimble
