// The handle's end of the controllers that render a fixture of their own (local_fixture.hpp), and the keys that they share.
// F positive pushes the hand out. SI units, frame: hand.
#pragma once

#include <array>

#include "common/control/built_in_controllers.hpp"
#include "common/control/local_fixture.hpp"

namespace thimble {

// The first keys of such a controller.
inline constexpr std::array kLocalFixtureKeys{
    thimble_controller_key{"local_stiffness_N_per_m", kByDefault.local.stiffness_N_per_m, 1, 1e6,
                           "Stiffness of the local fixture at the hand, before it is measured."},
    thimble_controller_key{"local_stiffest_N_per_m", kByDefault.local.stiffest_N_per_m, 1, 1e6,
                           "Upper limit of the stiffness; at least local_stiffness_N_per_m."},
    thimble_controller_key{"local_memory_samples", kByDefault.local.memory, 1, 1e6,
                           "Number of samples after which a contact is forgotten."},
    thimble_controller_key{"local_shift_m_per_s", kByDefault.local.shift_m_per_s, 1e-4, 10,
                           "Upper limit for the speed of the local plane."}};

inline LocalFixtureSettings local_fixture_of(const thimble_controller_settings& s) {
    LocalFixtureSettings local;
    local.stiffness_N_per_m = s.values[0];
    local.stiffest_N_per_m = s.values[1];
    local.memory = s.values[2];
    local.shift_m_per_s = s.values[3];
    local.sample_period_s = s.sample_period_s;
    return local;
}

// Tissue acts as it comes, the fixture as it is where the hand is now.
class LocalFixtureEnd {
  public:
    explicit LocalFixtureEnd(const thimble_controller_settings& settings)
        : settings_(settings), fixture_(local_fixture_of(settings)) {}
    void start(double /*delay_s*/) {
        fixture_.reset();
        position_hand_m_ = 0;
    }
    void sample(const thimble_handle& handle, thimble_packet& /*out*/) {
        position_hand_m_ = handle.position_hand_m;
        fixture_.next_sample();
    }
    void receive(const thimble_feedback& feedback) {
        fixture_.learn(feedback.position_hand_m, feedback.force_fixture_hand_N);
    }
    void forget() { fixture_.reset(); }
    double force_N(const thimble_feedback& newest) {
        return limited_N(newest.force_tissue_hand_N, settings_) + fixture_.force_N(position_hand_m_);
    }

  protected:
    thimble_controller_settings settings_;
    LocalFixture fixture_;

  private:
    double position_hand_m_ = 0;
};

}  // namespace thimble
