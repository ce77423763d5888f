// The codec's own: each body as a value and as a struct of the wire, and the ranges of docs/protocol.md. For codec.cpp only: no other file knows the wire's structs.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>

#include "common/codec.hpp"
#include "messages_generated.h"

namespace thimble {

// Far outside anything a needle does, far inside what arithmetic can hold.
inline constexpr double kMaxPosition_m = 10;
inline constexpr double kMaxVelocity_m_per_s = 1000;
inline constexpr double kMaxForce_N = 1e5;
inline constexpr double kMaxTime_s = 1e6;
inline constexpr double kMaxEnergy_J = 1e6;
inline constexpr std::int64_t kMaxStamp_ns = std::int64_t{1} << 62;

template <class Enum>
constexpr auto raw(Enum value) {
    return static_cast<std::uint8_t>(value);
}

// Collects the verdict over all fields of a message: not finite beats out of range. One comparison pair per
// number, which NaN fails too, keeps the common path short.
class Judge {
  public:
    void number(double value, double limit) { number(value, -limit, limit); }
    void number(double value, double low, double high) {
        if (value >= low && value <= high) return;
        (std::isfinite(value) ? in_range_ : finite_) = false;
    }
    void stamp(std::int64_t nanoseconds) {
        if (nanoseconds < 0 || nanoseconds > kMaxStamp_ns) in_range_ = false;
    }
    void require(bool in_range) { in_range_ = in_range_ && in_range; }
    template <class Enum>
    Enum choice(std::uint8_t value, Enum last) {
        if (value > raw(last)) in_range_ = false;
        return static_cast<Enum>(value);
    }
    std::optional<Refusal> verdict() const {
        if (!finite_) return Refusal::kNotFinite;
        return in_range_ ? std::nullopt : std::optional{Refusal::kOutOfRange};
    }

  private:
    bool finite_ = true, in_range_ = true;
};

inline wire::Header to_wire(const Header& h) {
    return {h.instance, to_nanoseconds(h.send_time), h.sequence, h.trial, static_cast<wire::Role>(h.sender)};
}

inline Header from_wire(const wire::Header& w, Judge& judge) {
    judge.stamp(w.send_time_ns());
    return {w.instance(), from_nanoseconds(w.send_time_ns()), w.sequence(), w.trial(),
            judge.choice(raw(w.sender()), Role::kExperimenter)};
}

inline wire::NeedleCommand to_wire(const NeedleCommand& b) {
    return {b.position_needle_m, b.velocity_needle_m_per_s, b.position_needle_estimate_m,
            b.position_hand_m,   b.velocity_hand_m_per_s,   b.force_hand_N};
}

inline NeedleCommand from_wire(const wire::NeedleCommand& w, Judge& judge) {
    judge.number(w.position_needle_m(), kMaxPosition_m);
    judge.number(w.velocity_needle_m_per_s(), kMaxVelocity_m_per_s);
    judge.number(w.position_needle_estimate_m(), kMaxPosition_m);
    judge.number(w.position_hand_m(), kMaxPosition_m);
    judge.number(w.velocity_hand_m_per_s(), kMaxVelocity_m_per_s);
    judge.number(w.force_hand_N(), kMaxForce_N);
    return {w.position_needle_m(), w.velocity_needle_m_per_s(), w.position_needle_estimate_m(),
            w.position_hand_m(),   w.velocity_hand_m_per_s(),   w.force_hand_N()};
}

inline wire::ForceFeedback to_wire(const ForceFeedback& b) {
    return {b.position_needle_m, b.position_surface_m, b.velocity_surface_m_per_s,
            b.position_proxy_m,  b.force_tissue_N,     b.force_fixture_N,
            b.force_total_N,     b.contact_time_s,     to_nanoseconds(b.echo_time),
            b.hold_time.count(), b.echo_sequence,      static_cast<wire::TissuePhase>(b.phase),
            b.fixture_present,   b.needle_held};
}

inline ForceFeedback from_wire(const wire::ForceFeedback& w, Judge& judge) {
    judge.number(w.position_needle_m(), kMaxPosition_m);
    judge.number(w.position_surface_m(), kMaxPosition_m);
    judge.number(w.velocity_surface_m_per_s(), kMaxVelocity_m_per_s);
    judge.number(w.position_proxy_m(), kMaxPosition_m);
    judge.number(w.force_tissue_N(), kMaxForce_N);
    judge.number(w.force_fixture_N(), kMaxForce_N);
    judge.number(w.force_total_N(), 2 * kMaxForce_N);
    judge.number(w.contact_time_s(), 0, kMaxTime_s);
    judge.stamp(w.echo_time_ns());
    judge.stamp(w.hold_time_ns());
    return {w.position_needle_m(),
            w.position_surface_m(),
            w.velocity_surface_m_per_s(),
            w.position_proxy_m(),
            w.force_tissue_N(),
            w.force_fixture_N(),
            w.force_total_N(),
            w.contact_time_s(),
            from_nanoseconds(w.echo_time_ns()),
            Duration{w.hold_time_ns()},
            w.echo_sequence(),
            judge.choice(raw(w.phase()), TissuePhase::kPenetrated),
            w.fixture_present(),
            w.needle_held()};
}

inline wire::Percept to_wire(const Percept& b) {
    return {b.force_N,
            b.bar_N,
            b.position_needle_shown_m,
            b.position_surface_shown_m,
            b.sample_age_s,
            static_cast<wire::Finger>(b.finger),
            b.touching_shown,
            b.beep};
}

inline Percept from_wire(const wire::Percept& w, Judge& judge) {
    judge.number(w.force_N(), 0, kMaxForce_N);
    judge.number(w.bar_N(), 0, kMaxForce_N);
    judge.number(w.position_needle_shown_m(), kMaxPosition_m);
    judge.number(w.position_surface_shown_m(), kMaxPosition_m);
    judge.number(w.sample_age_s(), 0, kMaxTime_s);
    return {w.force_N(),
            w.bar_N(),
            w.position_needle_shown_m(),
            w.position_surface_shown_m(),
            w.sample_age_s(),
            judge.choice(raw(w.finger()), Finger::kThumb),
            w.touching_shown(),
            w.beep()};
}

inline wire::NetworkName to_wire(const NetworkName& name) { return wire::NetworkName(name.text); }

inline NetworkName from_wire(const wire::NetworkName& w, Judge& judge) {
    NetworkName name;
    for (std::size_t i = 0; i < name.text.size(); ++i)
        name.text[i] = w.text()->Get(static_cast<flatbuffers::uoffset_t>(i));
    judge.require(name.well_formed());
    return name;
}

inline wire::SessionControl to_wire(const SessionControl& b) {
    return {b.study_seed,
            b.fixture_position_m,
            b.network_delay_s,
            b.silence_s,
            to_wire(b.network),
            b.subject,
            b.experiment,
            static_cast<wire::ControlKind>(b.kind),
            static_cast<wire::Modality>(b.modality),
            b.fixture_present,
            static_cast<wire::EndReason>(b.reason)};
}

inline SessionControl from_wire(const wire::SessionControl& w, Judge& judge) {
    judge.number(w.fixture_position_m(), kMaxPosition_m);
    judge.number(w.network_delay_s(), 0, kMaxTime_s);
    judge.number(w.silence_s(), 0, kMaxTime_s);
    return {w.study_seed(),
            w.fixture_position_m(),
            w.network_delay_s(),
            w.subject(),
            w.experiment(),
            judge.choice(raw(w.kind()), ControlKind::kNetworkChange),
            judge.choice(raw(w.modality()), Modality::kVF),
            w.fixture_present(),
            judge.choice(raw(w.reason()), kLastEndReason),
            w.silence_s(),
            from_wire(w.network(), judge)};
}

inline wire::Heartbeat to_wire(const Heartbeat& b) {
    return {b.accepted,
            b.refused,
            b.round_trip_median_s,
            b.round_trip_worst_s,
            b.hold_median_s,
            b.force_hand_N,
            b.energy_in_J,
            static_cast<wire::NodeState>(b.state),
            static_cast<wire::EndReason>(b.reason)};
}

inline Heartbeat from_wire(const wire::Heartbeat& w, Judge& judge) {
    judge.number(w.round_trip_median_s(), 0, kMaxTime_s);
    judge.number(w.round_trip_worst_s(), 0, kMaxTime_s);
    judge.number(w.hold_median_s(), 0, kMaxTime_s);
    judge.number(w.force_hand_N(), kMaxForce_N);
    judge.number(w.energy_in_J(), kMaxEnergy_J);
    return {w.accepted(),
            w.refused(),
            w.round_trip_median_s(),
            w.round_trip_worst_s(),
            w.hold_median_s(),
            w.force_hand_N(),
            w.energy_in_J(),
            judge.choice(raw(w.state()), NodeState::kFailed),
            judge.choice(raw(w.reason()), kLastEndReason)};
}

inline wire::ClockProbe to_wire(const ClockProbe& b) { return wire::ClockProbe(to_nanoseconds(b.send_time)); }

inline ClockProbe from_wire(const wire::ClockProbe& w, Judge& judge) {
    judge.stamp(w.send_time_ns());
    return {from_nanoseconds(w.send_time_ns())};
}

inline wire::ClockReply to_wire(const ClockReply& b) {
    return {to_nanoseconds(b.probe_send_time), to_nanoseconds(b.probe_arrival_time)};
}

inline ClockReply from_wire(const wire::ClockReply& w, Judge& judge) {
    judge.stamp(w.probe_send_time_ns());
    judge.stamp(w.probe_arrival_time_ns());
    return {from_nanoseconds(w.probe_send_time_ns()), from_nanoseconds(w.probe_arrival_time_ns())};
}

inline wire::HandInput to_wire(const HandInput& b) { return {b.position_hand_m, b.engaged}; }

inline HandInput from_wire(const wire::HandInput& w, Judge& judge) {
    judge.number(w.position_hand_m(), kMaxPosition_m);
    return {w.position_hand_m(), w.engaged()};
}

inline wire::Monitor to_wire(const Monitor& b) {
    return {b.time_s,
            b.position_needle_m,
            b.position_surface_m,
            b.position_fixture_m,
            b.force_tissue_N,
            b.force_fixture_N,
            b.force_total_N,
            b.contact_time_s,
            b.force_hand_N,
            b.energy_in_J,
            b.round_trip_s,
            b.one_way_s,
            b.one_way_bound_s,
            b.network_delay_s,
            to_wire(b.network),
            b.accepted,
            b.refused,
            b.subject,
            b.trials,
            static_cast<wire::TissuePhase>(b.phase),
            static_cast<wire::Modality>(b.modality),
            static_cast<wire::NodeState>(b.state),
            static_cast<wire::EndReason>(b.reason),
            b.fixture_present,
            b.needle_held,
            b.beeped,
            b.paused};
}

inline void judge_numbers(const wire::Monitor& w, Judge& judge) {
    for (const double position_m : {w.position_needle_m(), w.position_surface_m(), w.position_fixture_m()}) {
        judge.number(position_m, kMaxPosition_m);
    }
    for (const double force_N : {w.force_tissue_N(), w.force_fixture_N(), w.force_hand_N()}) {
        judge.number(force_N, kMaxForce_N);
    }
    judge.number(w.force_total_N(), 2 * kMaxForce_N);
    judge.number(w.energy_in_J(), kMaxEnergy_J);
    judge.number(w.one_way_s(), -1, kMaxTime_s);
    for (const double span_s :
         {w.time_s(), w.contact_time_s(), w.round_trip_s(), w.one_way_bound_s(), w.network_delay_s()}) {
        judge.number(span_s, 0, kMaxTime_s);
    }
}

inline Monitor from_wire(const wire::Monitor& w, Judge& judge) {
    judge_numbers(w, judge);
    return {w.time_s(),
            w.position_needle_m(),
            w.position_surface_m(),
            w.position_fixture_m(),
            w.force_tissue_N(),
            w.force_fixture_N(),
            w.force_total_N(),
            w.contact_time_s(),
            w.force_hand_N(),
            w.energy_in_J(),
            w.round_trip_s(),
            w.one_way_s(),
            w.one_way_bound_s(),
            w.network_delay_s(),
            w.accepted(),
            w.refused(),
            w.subject(),
            w.trials(),
            judge.choice(raw(w.phase()), TissuePhase::kPenetrated),
            judge.choice(raw(w.modality()), Modality::kVF),
            judge.choice(raw(w.state()), NodeState::kFailed),
            judge.choice(raw(w.reason()), kLastEndReason),
            w.fixture_present(),
            w.needle_held(),
            w.beeped(),
            w.paused(),
            from_wire(w.network(), judge)};
}

inline wire::Order to_wire(const Order& b) {
    return {b.value, to_wire(b.network), b.trial, static_cast<wire::OrderKind>(b.kind),
            static_cast<wire::Modality>(b.modality)};
}

inline Order from_wire(const wire::Order& w, Judge& judge) {
    judge.number(w.value(), 0, kMaxTime_s);
    return {w.value(), w.trial(), judge.choice(raw(w.kind()), OrderKind::kNetwork),
            judge.choice(raw(w.modality()), Modality::kVF), from_wire(w.network(), judge)};
}

inline wire::Page to_wire(const Page& b) {
    return {b.remaining_s, b.trial, b.trials, static_cast<wire::PageKind>(b.kind)};
}

inline Page from_wire(const wire::Page& w, Judge& judge) {
    judge.number(w.remaining_s(), 0, kMaxTime_s);
    return {w.remaining_s(), w.trial(), w.trials(), judge.choice(raw(w.kind()), PageKind::kWait)};
}

inline wire::ReplayState to_wire(const ReplayState& b) {
    return {b.duration_s, b.speed, b.contact_s, b.beep_s, b.change_s, b.changes};
}

inline ReplayState from_wire(const wire::ReplayState& w, Judge& judge) {
    ReplayState b{w.duration_s(), w.speed(), w.contact_s(), w.beep_s(), {}, w.changes()};
    judge.number(b.duration_s, 0, kMaxTime_s);
    judge.number(b.speed, 0, kMaxTime_s);
    judge.number(b.contact_s, -1, kMaxTime_s);
    judge.number(b.beep_s, -1, kMaxTime_s);
    for (std::size_t i = 0; i < b.change_s.size(); ++i) {
        b.change_s[i] = w.change_s()->Get(static_cast<flatbuffers::uoffset_t>(i));
        judge.number(b.change_s[i], 0, kMaxTime_s);
    }
    judge.require(b.changes <= b.change_s.size());
    return b;
}

inline wire::DeviceFault to_wire(const DeviceFault& b) {
    wire::DeviceFault w;
    static_assert(sizeof w == sizeof b.text);
    std::memcpy(&w, b.text.data(), sizeof w);
    return w;
}

// The text has an end for any bytes.
inline DeviceFault from_wire(const wire::DeviceFault& w, Judge& judge) {
    DeviceFault fault;
    std::memcpy(fault.text.data(), &w, sizeof w);
    judge.number(static_cast<unsigned char>(fault.text.back()), 0, 0);
    return fault;
}

inline wire::StopOrder to_wire(const StopOrder& b) {
    wire::StopOrder w;
    static_assert(sizeof w == sizeof b);
    std::memcpy(&w, static_cast<const void*>(&b), sizeof w);
    return w;
}

inline StopOrder from_wire(const wire::StopOrder& w, Judge& judge) {
    StopOrder b;
    b.id = w.id();
    b.held_ms = w.held_ms();
    b.kind = judge.choice(raw(w.kind()), StopKind::kAsk);
    b.reason = judge.choice(raw(w.reason()), kLastEndReason);
    judge.require(is_stop(b.reason));
    std::memcpy(b.text.data(), w.text()->Data(), b.text.size());
    judge.number(static_cast<unsigned char>(b.text.back()), 0, 0);
    return b;
}

}  // namespace thimble
