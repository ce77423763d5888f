// Compensators at the handle alone, as tables.
#include <array>
#include <cmath>

#include "common/control/built_in_controllers.hpp"
#include "common/control/energy_bound.hpp"
#include "common/control/local_fixture.hpp"
#include "common/control/passivity_controller.hpp"
#include "common/control/scaled_force.hpp"

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
    // Saturated before the compensator: what is wished for beyond the limit cannot be had.
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

class LocalFixtureEnd {
  public:
    explicit LocalFixtureEnd(const thimble_controller_settings& settings)
        : settings_(settings), fixture_(settings_of(settings)) {}
    void start(double /*delay_s*/) {
        fixture_.reset();
        position_hand_m_ = 0;
    }
    void sample(const thimble_handle& handle, thimble_packet& /*out*/) {
        position_hand_m_ = handle.position_hand_m;
    }
    void receive(const thimble_feedback& feedback) {
        fixture_.learn(feedback.position_hand_m, feedback.force_fixture_hand_N);
    }
    void forget() { fixture_.reset(); }
    double force_N(const thimble_feedback& newest) {
        return limited_N(newest.force_tissue_hand_N, settings_) + fixture_.force_N(position_hand_m_);
    }

  private:
    static LocalFixtureSettings settings_of(const thimble_controller_settings& s) {
        LocalFixtureSettings local;
        local.stiffness_N_per_m = s.values[0];
        local.stiffest_N_per_m = s.values[1];
        local.memory = s.values[2];
        local.shift_m_per_s = s.values[3];
        local.sample_period_s = s.sample_period_s;
        return local;
    }

    thimble_controller_settings settings_;
    LocalFixture fixture_;
    double position_hand_m_ = 0;
};

constexpr thimble_controller_key kDeviceDamping{"device_damping_Ns_per_m", 0.5, 0, 50,
                                                "Damping that the handle is certain to have."};
constexpr std::array kScaledKeys{thimble_controller_key{
    "share", 0.05, 0, 1, "Of the force, for the hand. The rest is pressed on the finger."}};
constexpr std::array kPassivityKeys{
    thimble_controller_key{"most_damping_Ns_per_m", 250, 0, 10000, "The controller's most damping."}};
constexpr std::array kBoundKeys{kDeviceDamping};
constexpr std::array kTankKeys{
    kDeviceDamping,
    thimble_controller_key{"tank_level_J", 0.05, 1e-6, 10, "Energy that the tank aims to hold."},
    thimble_controller_key{"tank_damping_Ns_per_m", 10, 0, 1000, "Damping that fills the tank."}};
constexpr std::array kFixtureKeys{
    thimble_controller_key{"local_stiffness_N_per_m", 3000, 1, 1e6, "At the hand, before it is learnt."},
    thimble_controller_key{"local_stiffest_N_per_m", 9000, 1, 1e6, "Never stiffer."},
    thimble_controller_key{"local_memory_samples", 200, 1, 1e6,
                           "Samples after which a contact is forgotten."},
    thimble_controller_key{"local_shift_m_per_s", 0.02, 1e-4, 10, "How fast the plane may move."}};

template <class Keys>
thimble_controller named(const char* name, const char* source, const Keys& keys,
                         std::uint32_t capabilities = 0) {
    thimble_controller table{};
    table.name = name;
    table.source = source;
    table.keys = keys.data();
    table.key_count = static_cast<std::uint32_t>(keys.size());
    table.capabilities = capabilities;
    return table;
}

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
        with_handle<LocalFixtureEnd>(named("local-fixture", "Mitra and Niemeyer 2008", kFixtureKeys)));
    return kTable;
}

}  // namespace thimble
