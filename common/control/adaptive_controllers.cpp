// Controllers that measure the network by the forces that come, as tables.
//
// adaptive-fixture: the local fixture of local_fixture.hpp (Mitra and Niemeyer 2008), with the jitter J of RFC 3550. Where a network
// jitters, pairs come in bursts and out of order. More pairs then count, and the plane moves more slowly:
//     memory (1 + J / h),   shift / (1 + J / h)
//
// predicted-share: all of the force for the skin, as in CF, and for the hand the share that the loop bears (the future work of
// Prattichizzo, Pacchierotti and Rosati 2012). A spring K with the delay T is passive with damping b while K (T + h / 2) <= b. The source
// is Colgate and Schenkel 1997, with a delay in docs/stability.md.
//
//     share = margin b / (K (T + h / 2)), at most 1,   T = A + 2 J as measured
#include <algorithm>
#include <array>
#include <cmath>

#include "common/control/age_estimate.hpp"
#include "common/control/built_in_controllers.hpp"
#include "common/control/local_fixture_end.hpp"

namespace thimble {
namespace {

class AdaptiveFixtureEnd : public LocalFixtureEnd {
  public:
    explicit AdaptiveFixtureEnd(const thimble_controller_settings& s)
        : LocalFixtureEnd(s), local_(local_fixture_of(s)) {}
    void start(double delay_s) {
        LocalFixtureEnd::start(delay_s);
        age_.start(delay_s);
        fixture_.adapt(local_.memory, local_.shift_m_per_s);
    }
    void receive(const thimble_feedback& feedback) {
        age_.add(feedback.age_s);
        const double spread = 1 + age_.jitter_s() / settings_.sample_period_s;
        fixture_.adapt(local_.memory * spread, local_.shift_m_per_s / spread);
        LocalFixtureEnd::receive(feedback);
    }

  private:
    LocalFixtureSettings local_;
    AgeEstimate age_;
};

class PredictedShareEnd {
  public:
    explicit PredictedShareEnd(const thimble_controller_settings& s)
        : settings_(s), damping_Ns_per_m_(s.values[0]), margin_(s.values[2]), fixture_(settings_of(s)) {}
    void start(double delay_s) {
        age_.start(delay_s);
        fixture_.reset();
    }
    void sample(const thimble_handle& /*handle*/, thimble_packet& /*out*/) {}
    void receive(const thimble_feedback& feedback) {
        age_.add(feedback.age_s);
        fixture_.learn(feedback.position_hand_m, feedback.force_fixture_hand_N);
    }
    void forget() { fixture_.reset(); }
    double force_N(const thimble_feedback& newest) const {
        return limited_N(share() * newest.force_total_hand_N, settings_);
    }

  private:
    static LocalFixtureSettings settings_of(const thimble_controller_settings& s) {
        LocalFixtureSettings local;
        local.stiffness_N_per_m = s.values[1];
        local.stiffest_N_per_m = 1e6;
        return local;
    }
    double share() const {
        const double delay_s = age_.mean_s() + 2 * age_.jitter_s() + settings_.sample_period_s / 2;
        return std::min(1.0, margin_ * damping_Ns_per_m_ / (fixture_.stiffness_N_per_m() * delay_s));
    }

    thimble_controller_settings settings_;
    double damping_Ns_per_m_, margin_;
    LocalFixture fixture_;  // for its stiffness alone
    AgeEstimate age_;
};

constexpr std::array kShareKeys{
    thimble_controller_key{"predicted_damping_Ns_per_m", kByDefault.predicted_damping_Ns_per_m, 0, 1000,
                           "Least damping of hand and handle together."},
    thimble_controller_key{"predicted_stiffness_N_per_m", kByDefault.predicted_stiffness_N_per_m, 1, 1e6,
                           "Stiffness of the fixture at the hand, before it is measured."},
    thimble_controller_key{"predicted_margin", kByDefault.predicted_margin, 0, 1,
                           "Part of the largest stable share that is used."}};

thimble_controller predicted_share_table() {
    thimble_controller table =
        named("predicted-share", "Prattichizzo, Pacchierotti and Rosati 2012, future work", kShareKeys,
              THIMBLE_AT_ONCE);
    table.hand_share = [](const thimble_controller_settings*) { return 0.0; };
    return with_memory<PredictedShareEnd>(with_handle<PredictedShareEnd>(table));
}

}  // namespace

const thimble_controller& adaptive_fixture_controller() {
    static const thimble_controller kTable = with_memory<AdaptiveFixtureEnd>(with_handle<AdaptiveFixtureEnd>(
        named("adaptive-fixture", "Mitra and Niemeyer 2008; RFC 3550", kLocalFixtureKeys)));
    return kTable;
}

const thimble_controller& predicted_share_controller() {
    static const thimble_controller kTable = predicted_share_table();
    return kTable;
}

}  // namespace thimble
