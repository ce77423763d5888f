#include "tests/views/demonstration.hpp"

#include <algorithm>
#include <cmath>

namespace thimble {
namespace {

constexpr double kRest_m = 0.02, kOscillation_Hz = 15;
constexpr double kStiffness_N_per_m = 700;
constexpr double kInsertion_m_per_s = kDemonstrationFixture_m / kDemonstrationContact_s;

void move(Monitor& monitor, double time_s) {
    const double held_s = std::max(0.0, time_s - kDemonstrationContact_s);
    const double swing_m =
        kDemonstrationAmplitude_m * std::min(1.0, held_s) * std::sin(2 * M_PI * kOscillation_Hz * held_s);
    monitor.position_needle_m = std::min(time_s * kInsertion_m_per_s, kDemonstrationFixture_m) + swing_m;
    const double dimple_m = monitor.position_needle_m - kRest_m;
    const bool inside = time_s > 1.2;
    monitor.position_surface_m =
        inside ? kRest_m + 0.01 * std::exp(-(time_s - 1.2) * 2) : kRest_m + std::max(0.0, dimple_m);
    monitor.phase =
        inside ? TissuePhase::kPenetrated : (dimple_m > 0 ? TissuePhase::kContact : TissuePhase::kFree);
}

}  // namespace

Monitor demonstration(double time_s) {
    time_s = std::max(0.0, time_s);  // who starts anew may ask before
    Monitor monitor;
    monitor.state = NodeState::kRunning;
    monitor.modality = Modality::kHF;
    monitor.time_s = time_s;
    monitor.subject = 3;
    monitor.trials = 24;
    monitor.position_fixture_m = kDemonstrationFixture_m;
    monitor.fixture_present = true;
    move(monitor, time_s);
    const double beyond_m = std::max(0.0, monitor.position_needle_m - kDemonstrationFixture_m);
    const double held_s = std::max(0.0, time_s - kDemonstrationContact_s);
    monitor.force_tissue_N = monitor.phase == TissuePhase::kFree ? 0 : -0.4;
    monitor.force_fixture_N = -kStiffness_N_per_m * beyond_m;
    monitor.force_total_N = monitor.force_tissue_N + monitor.force_fixture_N;
    monitor.force_hand_N = -monitor.force_total_N;
    monitor.contact_time_s = held_s;
    monitor.energy_in_J = 0.004 * std::min(time_s, kDemonstrationContact_s) - 0.006 * held_s;
    monitor.round_trip_s = 0.0512 + 0.0004 * std::sin(9 * time_s);
    monitor.one_way_s = 0.0503;
    monitor.one_way_bound_s = 0.004;
    monitor.network_delay_s = 0.05;
    monitor.accepted = static_cast<std::uint64_t>(time_s * 5000);
    return monitor;
}

}  // namespace thimble
