// Compensators at the handle alone, as tables.
#include <array>
#include <cmath>

#include "common/control/built_in_controllers.hpp"
#include "common/control/control_settings.hpp"
#include "common/control/energy_bound.hpp"
#include "common/control/local_fixture_end.hpp"
#include "common/control/passivity_controller.hpp"

namespace thimble {
namespace {

class ScaledEnd {
  public:
    explicit ScaledEnd(const thimble_controller_settings& settings)
        : share_{settings.values[0]}, force_limit_N_(settings.force_limit_N) {}
    void start(double /*delay_s*/) {}
    void sample(const thimble_handle& /*handle*/, thimble_packet& /*out*/) {}
    double force_N(const thimble_feedback& newest) const {
        return share_.hand_N(newest.force_total_hand_N, force_limit_N_);
    }

  private:
    ScaledForce share_;
    double force_limit_N_;
};

template <class Port>
class PortEnd {
  public:
    explicit PortEnd(const thimble_controller_settings& settings)
        : settings_(settings), port_(made(settings)) {}
    void start(double /*delay_s*/) { port_.reset(); }
    void sample(const thimble_handle& handle, thimble_packet& /*out*/) {
        port_.observe(handle.elapsed_s, handle.position_hand_m, handle.force_hand_N);
    }
    // Saturates before the compensator: it must not store energy for a force beyond the limit.
    double force_N(const thimble_feedback& newest) {
        return port_.force_N(limited_N(newest.force_total_hand_N, settings_));
    }

  private:
    static Port made(const thimble_controller_settings& s) {
        if constexpr (std::is_same_v<Port, PassivityController>)
            return Port({s.sample_period_s, 0}, s.values[0]);
        else if constexpr (std::is_same_v<Port, TwoLayerTank>)
            return Port({s.sample_period_s, s.values[0]}, TankSettings{s.values[1], s.values[2]});
        else
            return Port({s.sample_period_s, s.values[0]});
    }

    thimble_controller_settings settings_;
    Port port_;
};

constexpr thimble_controller_key kDeviceDamping{"device_damping_Ns_per_m", kByDefault.device_damping_Ns_per_m,
                                                0, 50, "Least damping of the handle."};
constexpr std::array kScaledKeys{thimble_controller_key{
    "share", kByDefault.share, 0, 1, "Share of the force for the hand. The rest is pressed on the finger."}};
constexpr std::array kPassivityKeys{kMostDamping};
constexpr std::array kBoundKeys{kDeviceDamping};
constexpr std::array kTankKeys{
    kDeviceDamping,
    thimble_controller_key{"tank_level_J", kByDefault.tank.level_J, 1e-6, 10,
                           "Energy that the tank should hold."},
    thimble_controller_key{"tank_damping_Ns_per_m", kByDefault.tank.damping_Ns_per_m, 0, 1000,
                           "Damping that fills the tank."}};

}  // namespace

const thimble_controller& scaled_controller() {
    static const thimble_controller kTable = [] {
        thimble_controller table = named("scaled", "Pacchierotti, Tirmizi, Bianchini and Prattichizzo 2013",
                                         kScaledKeys, THIMBLE_AT_ONCE);
        table.hand_share = [](const thimble_controller_settings* s) { return s->values[0]; };
        return with_handle<ScaledEnd>(table);
    }();
    return kTable;
}

const thimble_controller& passivity_controller() {
    static const thimble_controller kTable = with_handle<PortEnd<PassivityController>>(
        named("passivity", "Hannaford and Ryu 2002", kPassivityKeys));
    return kTable;
}

const thimble_controller& memoryless_bound_controller() {
    static const thimble_controller kTable = with_handle<PortEnd<MemorylessBound>>(
        named("energy-bound-memoryless", "Kim and Ryu 2010", kBoundKeys, THIMBLE_PASSIVE));
    return kTable;
}

const thimble_controller& least_conservative_controller() {
    static const thimble_controller kTable = with_handle<PortEnd<LeastConservativeBound>>(
        named("energy-bound", "Kim and Ryu 2010", kBoundKeys, THIMBLE_PASSIVE));
    return kTable;
}

const thimble_controller& two_layer_controller() {
    static const thimble_controller kTable = with_handle<PortEnd<TwoLayerTank>>(named(
        "two-layer", "Franken, Stramigioli, Misra, Secchi and Macchelli 2011", kTankKeys, THIMBLE_PASSIVE));
    return kTable;
}

const thimble_controller& local_fixture_controller() {
    static const thimble_controller kTable = with_memory<LocalFixtureEnd>(
        with_handle<LocalFixtureEnd>(named("local-fixture", "Mitra and Niemeyer 2008", kLocalFixtureKeys)));
    return kTable;
}

}  // namespace thimble
