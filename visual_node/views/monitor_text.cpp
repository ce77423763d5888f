#include "visual_node/views/monitor_text.hpp"

#include <algorithm>

namespace thimble {
namespace {

// Avoids -0.00, which means 0.00.
double without_sign_of_zero(double value, double resolution) {
    return value > -resolution / 2 && value <= 0 ? 0.0 : value;
}

TextLine not_known() { return TextLine::of("{}", kNotKnownText); }

TextLine fixture_text(const Monitor& monitor) {
    if (!monitor.fixture_present) return TextLine::of("removed");
    return length_text(monitor.position_fixture_m);
}

// The needle may be past the surface without having broken it: then the surface goes with it, and the depth is 0.
TextLine depth_text(const Monitor& monitor) {
    if (monitor.phase != TissuePhase::kPenetrated) return TextLine::of("outside");
    return length_text(monitor.position_needle_m - monitor.position_surface_m);
}

TextLine penetration_text(const Monitor& monitor) {
    if (!monitor.fixture_present) return TextLine::of("no fixture");
    return length_text(std::max(0.0, monitor.position_needle_m - monitor.position_fixture_m));
}

TextLine contact_text(const Monitor& monitor) {
    return TextLine::of("{:.2f} s{}", monitor.contact_time_s, monitor.beeped ? ", beep given" : "");
}

TextLine phase_text(const Monitor& monitor) {
    return TextLine::of("{}{}", to_string(monitor.phase), monitor.needle_held ? ", needle held" : "");
}

}  // namespace

TextLine length_text(double length_m) {
    return TextLine::of("{:.2f} mm", without_sign_of_zero(length_m * 1e3, 0.01));
}

TextLine force_text(double force_N) { return TextLine::of("{:.2f} N", without_sign_of_zero(force_N, 0.01)); }

TextLine time_text(double time_s) {
    if (time_s < 1) return TextLine::of("{:.1f} ms", time_s * 1e3);
    return TextLine::of("{:.2f} s", time_s);
}

TextLine energy_text(double energy_in_J) {
    return TextLine::of("{:.2f} mJ, {}", without_sign_of_zero(energy_in_J * 1e3, 0.01),
                        to_string(judge_energy(energy_in_J)));
}

TextLine age_text(Duration age) {
    if (age == Duration::max()) return TextLine::of("no message yet");
    const double age_s = to_seconds(age);
    if (age_s < 1) return TextLine::of("{:.0f} ms", age_s * 1e3);
    if (age_s < 120) return TextLine::of("{:.1f} s", age_s);
    const auto minutes = static_cast<long>(age_s / 60);
    return minutes < 120 ? TextLine::of("{} min", minutes)
                         : TextLine::of("{} h {} min", minutes / 60, minutes % 60);
}

TextLine one_way_text(double one_way_s, double one_way_bound_s) {
    if (one_way_s < 0 || one_way_bound_s >= one_way_s) return not_known();
    return TextLine::of("{} ± {}", time_text(one_way_s).view(), time_text(one_way_bound_s).view());
}

TextLine round_trip_text(double round_trip_s) {
    return round_trip_s > 0 ? time_text(round_trip_s) : not_known();
}

TextLine trial_text(std::uint32_t trial, std::uint32_t trials) {
    if (trial == 0) return TextLine::of("none yet");
    if (trials == 0) return TextLine::of("{}, no planned number", trial);
    return TextLine::of("{} of {}", trial, trials);
}

TextLine state_text(const Monitor& monitor) {
    if (monitor.state == NodeState::kRunning) {
        return TextLine::of("running, {:.1f} s{}", monitor.time_s, monitor.paused ? ", then a pause" : "");
    }
    const char* waiting = monitor.paused ? "paused" : "between trials";
    if (monitor.reason == EndReason::kNone) return TextLine::of("{}", waiting);
    return TextLine::of("{}, last: {}", waiting, to_string(monitor.reason));
}

std::array<Reading, kReadingCount> read_monitor(const Monitor& monitor, std::uint32_t trial) {
    return {{
        {"trial", trial_text(trial, monitor.trials)},
        {"subject", TextLine::of("{}", monitor.subject)},
        {"modality", TextLine::of("{}", to_string(monitor.modality))},
        {"state", state_text(monitor)},
        {"tissue", phase_text(monitor)},
        {"contact", contact_text(monitor)},
        {"needle", length_text(monitor.position_needle_m)},
        {"in tissue", depth_text(monitor)},
        {"fixture", fixture_text(monitor)},
        {"beyond fixture", penetration_text(monitor)},
        {"tissue force", force_text(-monitor.force_tissue_N)},
        {"fixture force", force_text(-monitor.force_fixture_N)},
        {"handle force", force_text(monitor.force_hand_N)},
        {"port energy", energy_text(monitor.energy_in_J)},
        {"round trip", round_trip_text(monitor.round_trip_s)},
        {"one way", one_way_text(monitor.one_way_s, monitor.one_way_bound_s)},
        {"set delay", time_text(monitor.network_delay_s)},
        {"packets", TextLine::of("{} in, {} rejected", monitor.accepted, monitor.refused)},
    }};
}

EnergyBalance judge_energy(double energy_in_J) {
    if (energy_in_J < -kEnergyResolution_J) return EnergyBalance::kActive;
    if (energy_in_J > kEnergyResolution_J) return EnergyBalance::kPassive;
    return EnergyBalance::kNone;
}

const char* to_string(EnergyBalance energy) {
    static constexpr std::array kNames{"none yet", "passive", "gives out more than it received"};
    return kNames.at(static_cast<std::size_t>(energy));
}

}  // namespace thimble
