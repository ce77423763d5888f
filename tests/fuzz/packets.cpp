#include "tests/fuzz/packets.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "common/codec.hpp"

namespace thimble {
namespace {

// Structured bindings name every field, so a field that is added and forgotten here does not compile.
auto fields(const Header& m) {
    const auto& [instance, send_time, sequence, trial, sender] = m;
    return std::tie(instance, send_time, sequence, trial, sender);
}
auto fields(const NeedleCommand& m) {
    const auto& [needle, velocity, estimate, hand, hand_velocity, force] = m;
    return std::tie(needle, velocity, estimate, hand, hand_velocity, force);
}
auto fields(const ForceFeedback& m) {
    const auto& [needle, surface, surface_velocity, proxy, tissue, fixture, total, contact, echo_time,
                 hold_time, echo_sequence, phase, present, held] = m;
    return std::tie(needle, surface, surface_velocity, proxy, tissue, fixture, total, contact, echo_time,
                    hold_time, echo_sequence, phase, present, held);
}
auto fields(const Percept& m) {
    const auto& [force, bar, needle, surface, age, finger, touching, beep] = m;
    return std::tie(force, bar, needle, surface, age, finger, touching, beep);
}
auto fields(const SessionControl& m) {
    const auto& [seed, fixture, network_delay, subject, experiment, kind, modality, present, reason, silence,
                 network] = m;
    return std::tie(seed, fixture, network_delay, subject, experiment, kind, modality, present, reason,
                    silence, network);
}
auto fields(const Heartbeat& m) {
    const auto& [accepted, refused, median, worst, hold, force, energy, state, reason] = m;
    return std::tie(accepted, refused, median, worst, hold, force, energy, state, reason);
}

auto fields(const ClockProbe& m) {
    const auto& [send_time] = m;
    return std::tie(send_time);
}
auto fields(const ClockReply& m) {
    const auto& [probe_send_time, probe_arrival_time] = m;
    return std::tie(probe_send_time, probe_arrival_time);
}
auto fields(const HandInput& m) {
    const auto& [position, engaged] = m;
    return std::tie(position, engaged);
}
auto fields(const Monitor& m) {
    const auto& [time, needle, surface, fixture, tissue_force, fixture_force, total, contact, hand, energy,
                 round_trip, one_way, bound, delay, accepted, refused, subject, trials, phase, modality,
                 state, reason, present, held, beeped, paused, network] = m;
    return std::tie(time, needle, surface, fixture, tissue_force, fixture_force, total, contact, hand, energy,
                    round_trip, one_way, bound, delay, accepted, refused, subject, trials, phase, modality,
                    state, reason, present, held, beeped, paused, network);
}
auto fields(const Order& m) {
    const auto& [value, trial, kind, modality, network] = m;
    return std::tie(value, trial, kind, modality, network);
}
auto fields(const Page& m) {
    const auto& [remaining, trial, trials, kind] = m;
    return std::tie(remaining, trial, trials, kind);
}
auto fields(const ReplayState& m) {
    const auto& [duration, speed, contact, beep, change, changes] = m;
    return std::tie(duration, speed, contact, beep, change, changes);
}

auto fields(const DeviceFault& m) { return std::tie(m.text); }
auto fields(const WaveBurst& m) {
    const auto& [wave, sum, energy, number, count] = m;
    return std::tie(wave, sum, energy, number, count);
}
auto fields(const NeedleWave& m) { return std::tuple_cat(fields(m.command), fields(m.waves)); }
auto fields(const ForceWave& m) { return std::tuple_cat(fields(m.feedback), fields(m.waves)); }
auto fields(const StopOrder& m) { return std::tie(m.id, m.held_ms, m.kind, m.reason, m.text); }

// A NaN fails every comparison.
bool within(double value, double low, double high) { return value >= low && value <= high; }
bool position(double value_m) { return within(value_m, -10, 10); }
bool velocity(double value_m_per_s) { return within(value_m_per_s, -1000, 1000); }
bool force(double value_N) { return within(value_N, -1e5, 1e5); }
bool span(double value_s) { return within(value_s, 0, 1e6); }
bool stamp(std::int64_t nanoseconds) { return nanoseconds >= 0 && nanoseconds <= std::int64_t{1} << 62; }
bool stamp(SessionTime time) { return stamp(to_nanoseconds(time)); }

bool plausible_header(const Header& m) { return stamp(m.send_time) && m.sender <= Role::kExperimenter; }

bool plausible_body(const NeedleCommand& m) {
    return position(m.position_needle_m) && velocity(m.velocity_needle_m_per_s) &&
           position(m.position_needle_estimate_m) && position(m.position_hand_m) &&
           velocity(m.velocity_hand_m_per_s) && force(m.force_hand_N);
}
bool plausible_body(const ForceFeedback& m) {
    return position(m.position_needle_m) && position(m.position_surface_m) &&
           velocity(m.velocity_surface_m_per_s) && position(m.position_proxy_m) && force(m.force_tissue_N) &&
           force(m.force_fixture_N) && within(m.force_total_N, -2e5, 2e5) && span(m.contact_time_s) &&
           stamp(m.echo_time) && stamp(m.hold_time.count()) && m.phase <= TissuePhase::kPenetrated;
}
bool plausible_body(const Percept& m) {
    return within(m.force_N, 0, 1e5) && within(m.bar_N, 0, 1e5) && position(m.position_needle_shown_m) &&
           position(m.position_surface_shown_m) && span(m.sample_age_s) && m.finger <= Finger::kThumb;
}
bool plausible_body(const SessionControl& m) {
    return position(m.fixture_position_m) && span(m.network_delay_s) && span(m.silence_s) &&
           m.network.well_formed() && m.kind <= ControlKind::kNetworkChange && m.modality <= Modality::kVF &&
           m.reason <= kLastEndReason;
}
bool plausible_body(const Heartbeat& m) {
    return span(m.round_trip_median_s) && span(m.round_trip_worst_s) && span(m.hold_median_s) &&
           force(m.force_hand_N) && within(m.energy_in_J, -1e6, 1e6) && m.state <= NodeState::kFailed &&
           m.reason <= kLastEndReason;
}
bool plausible_body(const HandInput& m) { return position(m.position_hand_m); }
bool plausible_body(const Monitor& m) {
    return span(m.time_s) && position(m.position_needle_m) && position(m.position_surface_m) &&
           position(m.position_fixture_m) && force(m.force_tissue_N) && force(m.force_fixture_N) &&
           within(m.force_total_N, -2e5, 2e5) && span(m.contact_time_s) && force(m.force_hand_N) &&
           within(m.energy_in_J, -1e6, 1e6) && span(m.round_trip_s) && within(m.one_way_s, -1, 1e6) &&
           span(m.one_way_bound_s) && span(m.network_delay_s) && m.phase <= TissuePhase::kPenetrated &&
           m.modality <= Modality::kVF && m.state <= NodeState::kFailed && m.reason <= kLastEndReason &&
           m.network.well_formed();
}
bool plausible_body(const Order& m) {
    return span(m.value) && m.kind <= OrderKind::kNetwork && m.modality <= Modality::kVF &&
           m.network.well_formed();
}
bool plausible_body(const ReplayState& m) {
    return span(m.duration_s) && span(m.speed) && within(m.contact_s, -1, 1e6) && within(m.beep_s, -1, 1e6) &&
           m.changes <= ReplayState::kMostChanges &&
           std::all_of(m.change_s.begin(), m.change_s.end(), [](double time_s) { return span(time_s); });
}
bool plausible_body(const Page& m) { return span(m.remaining_s) && m.kind <= PageKind::kWait; }
bool plausible_body(const DeviceFault& m) { return m.words().size() < m.text.size(); }
bool plausible_waves(const WaveBurst& m) {
    return std::all_of(m.wave_root_W.begin(), m.wave_root_W.end(),
                       [](double wave_root_W) { return within(wave_root_W, -1e6, 1e6); }) &&
           within(m.sum_root_W_s, -1e12, 1e12) && within(m.energy_J, 0, 1e12) && m.count <= WaveBurst::kMost;
}
bool plausible_body(const NeedleWave& m) { return plausible_body(m.command) && plausible_waves(m.waves); }
bool plausible_body(const ForceWave& m) { return plausible_body(m.feedback) && plausible_waves(m.waves); }
bool plausible_body(const StopOrder& m) {
    return m.kind <= StopKind::kAsk && is_stop(m.reason) && m.words().size() < m.text.size();
}
bool plausible_body(const ClockProbe& m) { return stamp(m.send_time); }
bool plausible_body(const ClockReply& m) { return stamp(m.probe_send_time) && stamp(m.probe_arrival_time); }

}  // namespace

std::vector<Message> sample_messages() {
    const Header header{0x1122334455667788, from_nanoseconds(1'234'567'890), 42, 7, Role::kSlaveSim};
    ForceFeedback feedback{0.031,
                           0.012,
                           -0.002,
                           0.029,
                           -0.8,
                           -2.5,
                           -3.3,
                           1.25,
                           from_nanoseconds(1'200'000'000),
                           Duration{150'000},
                           41,
                           TissuePhase::kPenetrated,
                           true,
                           true};
    Monitor monitor;
    monitor.time_s = 2.5;
    monitor.position_needle_m = 0.031;
    monitor.force_total_N = -3.3;
    monitor.energy_in_J = -0.01;
    monitor.accepted = 123'456;
    monitor.state = NodeState::kRunning;
    monitor.paused = true;
    monitor.network = *NetworkName::of("transatlantic");
    const WaveBurst waves{{0.5, -0.25, 0, 0, 0, 0, 0, 0.125}, 0.75, 1.5, 1000, 8};
    ReplayState replay{12.5, 0.5, 1.25, 6.5, {}, 2};
    replay.change_s[1] = 3.5;
    return {{header, NeedleCommand{0.03, 0.06, 0.0299, 0.01, 0.02, 1.5}},
            {header, feedback},
            {header, Percept{0.9, 3.1, -0.004, 0.001, 0.052, Finger::kThumb, true, true}},
            {header, SessionControl{99, 0.025, 0.05, 3, 2, ControlKind::kFixtureChange, Modality::kCCF, true,
                                    EndReason::kTimeout, 0.6, *NetworkName::of("geo")}},
            {header,
             Heartbeat{1000, 3, 0.101, 0.13, 0.0002, 1.5, -0.02, NodeState::kRunning, EndReason::kPeerLost}},
            {header, ClockProbe{from_nanoseconds(987'654'321)}},
            {header, ClockReply{from_nanoseconds(987'654'321), from_nanoseconds(55'000'000'123)}},
            {header, HandInput{0.02, true}},
            {header, monitor},
            {header, Order{0.05, 4, OrderKind::kNetwork, Modality::kCCF, *NetworkName::of("5g-nsa")}},
            {header, Page{12.5, 3, 24, PageKind::kBreak}},
            {header, replay},
            {header, DeviceFault("the handle is unplugged; plug it in")},
            {header, NeedleWave{{0.03, 0.06, 0.0299, 0.01, 0.02, 1.5}, waves}},
            {header, ForceWave{feedback, waves}},
            {header, StopOrder(77, StopKind::kStop, EndReason::kSafetyStop, "the handle gave 0.3 J")}};
}

bool plausible(const Message& message) {
    return plausible_header(message.header) &&
           std::visit([](const auto& body) { return plausible_body(body); }, message.body);
}

bool same(const Message& a, const Message& b) {
    if (fields(a.header) != fields(b.header) || a.body.index() != b.body.index()) return false;
    return std::visit(
        [&](const auto& body) {
            return fields(body) == fields(std::get<std::decay_t<decltype(body)>>(b.body));
        },
        a.body);
}

const char* flaw_of(const Message& accepted) {
    if (!plausible(accepted)) return "a number or an enum out of its range was accepted";
    Encoder encoder;
    const Decoded again = decode(encoder.encode(accepted));
    if (!again.message) return "an accepted message is refused after encoding it again";
    if (!same(accepted, *again.message)) return "an accepted message changes when it is encoded again";
    return nullptr;
}

}  // namespace thimble
