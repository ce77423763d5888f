#include "tests/fuzz/packets.hpp"

#include <algorithm>
#include <span>

#include "common/codec.hpp"
#include "tests/fuzz/checks.hpp"

namespace thimble {
namespace {

using Numbers = std::vector<LegalNumber>;

Numbers operator+(Numbers first, const Numbers& second) {
    first.insert(first.end(), second.begin(), second.end());
    return first;
}

// The ranges of the page, by quantity.
Numbers within(double low, double high, std::span<double* const> values) {
    Numbers all;
    for (double* const value : values) all.push_back({value, low, high});
    return all;
}
using Doubles = std::vector<double*>;
Numbers places_m(const Doubles& values) { return within(-10, 10, values); }
Numbers speeds_m_per_s(const Doubles& values) { return within(-1000, 1000, values); }
Numbers forces_N(const Doubles& values) { return within(-1e5, 1e5, values); }
Numbers sums_N(const Doubles& values) { return within(-2e5, 2e5, values); }
Numbers shown_N(const Doubles& values) { return within(0, 1e5, values); }
Numbers energies_J(const Doubles& values) { return within(-1e6, 1e6, values); }
Numbers spans_s(const Doubles& values) { return within(0, 1e6, values); }
Numbers known_spans_s(const Doubles& values) { return within(-1, 1e6, values); }

Numbers numbers(NeedleCommand& m) {
    return places_m({&m.position_needle_m, &m.position_needle_estimate_m, &m.position_hand_m}) +
           speeds_m_per_s({&m.velocity_needle_m_per_s, &m.velocity_hand_m_per_s}) +
           forces_N({&m.force_hand_N});
}
Numbers numbers(ForceFeedback& m) {
    return places_m({&m.position_needle_m, &m.position_surface_m, &m.position_proxy_m}) +
           speeds_m_per_s({&m.velocity_surface_m_per_s}) + forces_N({&m.force_tissue_N, &m.force_fixture_N}) +
           sums_N({&m.force_total_N}) + spans_s({&m.contact_time_s});
}
Numbers numbers(Percept& m) {
    return shown_N({&m.force_N, &m.bar_N}) +
           places_m({&m.position_needle_shown_m, &m.position_surface_shown_m}) + spans_s({&m.sample_age_s});
}
Numbers numbers(SessionControl& m) {
    return places_m({&m.fixture_position_m}) + spans_s({&m.network_delay_s, &m.silence_s});
}
Numbers numbers(Heartbeat& m) {
    return spans_s({&m.round_trip_median_s, &m.round_trip_worst_s, &m.hold_median_s}) +
           forces_N({&m.force_hand_N}) + energies_J({&m.energy_in_J});
}
Numbers numbers(HandInput& m) { return places_m({&m.position_hand_m}); }
Numbers numbers(Monitor& m) {
    return places_m({&m.position_needle_m, &m.position_surface_m, &m.position_fixture_m}) +
           forces_N({&m.force_tissue_N, &m.force_fixture_N, &m.force_hand_N}) + sums_N({&m.force_total_N}) +
           energies_J({&m.energy_in_J}) + known_spans_s({&m.one_way_s}) +
           spans_s({&m.time_s, &m.contact_time_s, &m.round_trip_s, &m.one_way_bound_s, &m.network_delay_s});
}
Numbers numbers(Order& m) { return spans_s({&m.value}); }
Numbers numbers(Page& m) { return spans_s({&m.remaining_s}); }
Numbers numbers(ReplayState& m) {
    Numbers all = spans_s({&m.duration_s, &m.speed}) + known_spans_s({&m.contact_s, &m.beep_s});
    for (double& time_s : m.change_s) all.push_back({&time_s, 0, 1e6});
    return all;
}
Numbers numbers(WaveBurst& m) {
    Numbers all{{&m.sum_root_W_s, -1e12, 1e12}, {&m.energy_J, 0, 1e12}};
    for (double& wave_root_W : m.wave_root_W) all.push_back({&wave_root_W, -1e6, 1e6});
    return all;
}
Numbers numbers(NeedleWave& m) { return numbers(m.command) + numbers(m.waves); }
Numbers numbers(ForceWave& m) { return numbers(m.feedback) + numbers(m.waves); }
template <class Body>
Numbers numbers(Body& /*without any*/) {
    return {};
}

bool stamp(std::int64_t nanoseconds) { return nanoseconds >= 0 && nanoseconds <= std::int64_t{1} << 62; }
bool stamp(SessionTime time) { return stamp(to_nanoseconds(time)); }

// All but the numbers.
bool plausible_rest(const Header& m) { return stamp(m.send_time) && m.sender <= Role::kExperimenter; }
bool plausible_rest(const ForceFeedback& m) {
    return stamp(m.echo_time) && stamp(m.hold_time.count()) && m.phase <= TissuePhase::kPenetrated;
}
bool plausible_rest(const Percept& m) { return m.finger <= Finger::kThumb; }
bool plausible_rest(const SessionControl& m) {
    return m.network.well_formed() && m.kind <= ControlKind::kNetworkChange && m.modality <= Modality::kVF &&
           m.reason <= kLastEndReason;
}
bool plausible_rest(const Heartbeat& m) {
    return m.state <= NodeState::kFailed && m.reason <= kLastEndReason;
}
bool plausible_rest(const Monitor& m) {
    return m.phase <= TissuePhase::kPenetrated && m.modality <= Modality::kVF &&
           m.state <= NodeState::kFailed && m.reason <= kLastEndReason && m.network.well_formed();
}
bool plausible_rest(const Order& m) {
    return m.kind <= OrderKind::kAnswer && m.modality <= Modality::kVF && m.network.well_formed();
}
bool plausible_rest(const ReplayState& m) { return m.changes <= ReplayState::kMostChanges; }
bool plausible_rest(const Page& m) { return m.kind <= PageKind::kQuestion; }
bool plausible_rest(const DeviceFault& m) { return m.words().size() < m.text.size(); }
bool plausible_rest(const NeedleWave& m) { return m.waves.count <= WaveBurst::kMost; }
bool plausible_rest(const ForceWave& m) {
    return plausible_rest(m.feedback) && m.waves.count <= WaveBurst::kMost;
}
bool plausible_rest(const StopOrder& m) {
    return m.kind <= StopKind::kAsk && is_stop(m.reason) && m.words().size() < m.text.size();
}
bool plausible_rest(const ClockProbe& m) { return stamp(m.send_time); }
bool plausible_rest(const ClockReply& m) { return stamp(m.probe_send_time) && stamp(m.probe_arrival_time); }
template <class Body>
bool plausible_rest(const Body& /*numbers alone*/) {
    return true;
}

}  // namespace

std::vector<Message> sample_messages() {
    const Header header{0x1122334455667788, from_nanoseconds(1'234'567'890), 42, 7, Role::kSlaveSim};
    ForceFeedback feedback{0.031, 0.012, -0.002, 0.029, -0.8, -2.5, -3.3, 1.25};
    feedback.echo_time = from_nanoseconds(1'200'000'000);
    feedback.hold_time = Duration{150'000};
    feedback.echo_sequence = 41;
    feedback.phase = TissuePhase::kPenetrated;
    feedback.fixture_present = feedback.needle_held = true;
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

std::vector<LegalNumber> numbers_of(Body& body) {
    return std::visit([](auto& message) { return numbers(message); }, body);
}

// A NaN fails every comparison.
bool plausible(Message message) {
    const Numbers all = numbers_of(message.body);
    return plausible_rest(message.header) &&
           std::all_of(all.begin(), all.end(),
                       [](const LegalNumber& n) { return *n.value >= n.low && *n.value <= n.high; }) &&
           std::visit([](const auto& body) { return plausible_rest(body); }, message.body);
}

const char* flaw_of(const Message& accepted) {
    if (!plausible(accepted)) return "a number or an enum out of its range was accepted";
    Encoder encoder;
    const Decoded again = decode(encoder.encode(accepted));
    if (!again.message) return "an accepted message is refused after encoding it again";
    if (accepted != *again.message) return "an accepted message changes when it is encoded again";
    return nullptr;
}

Verdict check_decode(Bytes datagram) {
    const Decoded decoded = decode(datagram);
    if (!decoded.message) return {false, decoded.refusal ? "" : "refused without a reason"};
    const char* flaw = flaw_of(*decoded.message);
    return {true, flaw != nullptr ? flaw : ""};
}

}  // namespace thimble
