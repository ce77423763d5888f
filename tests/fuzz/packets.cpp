#include "tests/fuzz/packets.hpp"

#include <algorithm>

#include "common/codec.hpp"
#include "tests/fuzz/checks.hpp"

namespace thimble {
namespace {

using Numbers = std::vector<LegalNumber>;

Numbers numbers(NeedleCommand& m) {
    return {{&m.position_needle_m, -10, 10},          {&m.velocity_needle_m_per_s, -1000, 1000},
            {&m.position_needle_estimate_m, -10, 10}, {&m.position_hand_m, -10, 10},
            {&m.velocity_hand_m_per_s, -1000, 1000},  {&m.force_hand_N, -1e5, 1e5}};
}
Numbers numbers(ForceFeedback& m) {
    return {{&m.position_needle_m, -10, 10},
            {&m.position_surface_m, -10, 10},
            {&m.velocity_surface_m_per_s, -1000, 1000},
            {&m.position_proxy_m, -10, 10},
            {&m.force_tissue_N, -1e5, 1e5},
            {&m.force_fixture_N, -1e5, 1e5},
            {&m.force_total_N, -2e5, 2e5},
            {&m.contact_time_s, 0, 1e6}};
}
Numbers numbers(Percept& m) {
    return {{&m.force_N, 0, 1e5},
            {&m.bar_N, 0, 1e5},
            {&m.position_needle_shown_m, -10, 10},
            {&m.position_surface_shown_m, -10, 10},
            {&m.sample_age_s, 0, 1e6}};
}
Numbers numbers(SessionControl& m) {
    return {{&m.fixture_position_m, -10, 10}, {&m.network_delay_s, 0, 1e6}, {&m.silence_s, 0, 1e6}};
}
Numbers numbers(Heartbeat& m) {
    return {{&m.round_trip_median_s, 0, 1e6},
            {&m.round_trip_worst_s, 0, 1e6},
            {&m.hold_median_s, 0, 1e6},
            {&m.force_hand_N, -1e5, 1e5},
            {&m.energy_in_J, -1e6, 1e6}};
}
Numbers numbers(HandInput& m) { return {{&m.position_hand_m, -10, 10}}; }
Numbers numbers(Monitor& m) {
    return {{&m.time_s, 0, 1e6},
            {&m.position_needle_m, -10, 10},
            {&m.position_surface_m, -10, 10},
            {&m.position_fixture_m, -10, 10},
            {&m.force_tissue_N, -1e5, 1e5},
            {&m.force_fixture_N, -1e5, 1e5},
            {&m.force_total_N, -2e5, 2e5},
            {&m.contact_time_s, 0, 1e6},
            {&m.force_hand_N, -1e5, 1e5},
            {&m.energy_in_J, -1e6, 1e6},
            {&m.round_trip_s, 0, 1e6},
            {&m.one_way_s, -1, 1e6},
            {&m.one_way_bound_s, 0, 1e6},
            {&m.network_delay_s, 0, 1e6}};
}
Numbers numbers(Order& m) { return {{&m.value, 0, 1e6}}; }
Numbers numbers(Page& m) { return {{&m.remaining_s, 0, 1e6}}; }
Numbers numbers(ReplayState& m) {
    Numbers all{{&m.duration_s, 0, 1e6}, {&m.speed, 0, 1e6}, {&m.contact_s, -1, 1e6}, {&m.beep_s, -1, 1e6}};
    for (double& time_s : m.change_s) all.push_back({&time_s, 0, 1e6});
    return all;
}
Numbers numbers(WaveBurst& m) {
    Numbers all{{&m.sum_root_W_s, -1e12, 1e12}, {&m.energy_J, 0, 1e12}};
    for (double& wave_root_W : m.wave_root_W) all.push_back({&wave_root_W, -1e6, 1e6});
    return all;
}
Numbers both(Numbers first, const Numbers& second) {
    first.insert(first.end(), second.begin(), second.end());
    return first;
}
Numbers numbers(NeedleWave& m) { return both(numbers(m.command), numbers(m.waves)); }
Numbers numbers(ForceWave& m) { return both(numbers(m.feedback), numbers(m.waves)); }
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
    return m.kind <= OrderKind::kNetwork && m.modality <= Modality::kVF && m.network.well_formed();
}
bool plausible_rest(const ReplayState& m) { return m.changes <= ReplayState::kMostChanges; }
bool plausible_rest(const Page& m) { return m.kind <= PageKind::kWait; }
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
