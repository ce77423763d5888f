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
#include "common/control/local_fixture.hpp"

namespace thimble {
namespace {

class AdaptiveFixtureEnd {
  public:
    explicit AdaptiveFixtureEnd(const thimble_controller_settings& s)
        : settings_(s),
          local_{s.values[0],      s.values[1],
                 s.values[2],      LocalFixtureSettings{}.span_m,
                 s.values[3],      LocalFixtureSettings{}.lost_m,
                 s.sample_period_s},
          fixture_(local_) {}
    void start(double delay_s) {
        age_.start(delay_s);
        fixture_.reset();
        fixture_.adapt(local_.memory, local_.shift_m_per_s);
        position_hand_m_ = 0;
    }
    void sample(const thimble_handle& handle, thimble_packet& /*out*/) {
        position_hand_m_ = handle.position_hand_m;
    }
    void receive(const thimble_feedback& feedback) {
        age_.add(feedback.age_s);
        const double spread = 1 + age_.jitter_s() / settings_.sample_period_s;
        fixture_.adapt(local_.memory * spread, local_.shift_m_per_s / spread);
        fixture_.learn(feedback.position_hand_m, feedback.force_fixture_hand_N);
    }
    void forget() { fixture_.reset(); }
    double force_N(const thimble_feedback& newest) {
        return limited_N(newest.force_tissue_hand_N, settings_) + fixture_.force_N(position_hand_m_);
    }

  private:
    thimble_controller_settings settings_;
    LocalFixtureSettings local_;
    LocalFixture fixture_;
    AgeEstimate age_;
    double position_hand_m_ = 0;
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

constexpr std::array kAdaptiveFixtureKeys{
    thimble_controller_key{"local_stiffness_N_per_m", 3000, 1, 1e6, "At the hand, before it is learnt."},
    thimble_controller_key{"local_stiffest_N_per_m", 9000, 1, 1e6, "Never stiffer."},
    thimble_controller_key{"local_memory_samples", 200, 1, 1e6,
                           "Samples after which a contact is forgotten."},
    thimble_controller_key{"local_shift_m_per_s", 0.02, 1e-4, 10, "How fast the plane may move."}};
constexpr std::array kShareKeys{
    thimble_controller_key{"predicted_damping_Ns_per_m", 15, 0, 1000,
                           "Damping that hand and handle are certain to have."},
    thimble_controller_key{"predicted_stiffness_N_per_m", 9000, 1, 1e6,
                           "Of the fixture at the hand, before it is learnt."},
    thimble_controller_key{"predicted_margin", 0.8, 0, 1, "Of the largest share that is stable."}};

thimble_controller adaptive_fixture_table() {
    thimble_controller table{};
    table.name = "adaptive-fixture";
    table.source = "Mitra and Niemeyer 2008; RFC 3550";
    table.keys = kAdaptiveFixtureKeys.data();
    table.key_count = static_cast<std::uint32_t>(kAdaptiveFixtureKeys.size());
    return with_memory<AdaptiveFixtureEnd>(with_handle<AdaptiveFixtureEnd>(table));
}

thimble_controller predicted_share_table() {
    thimble_controller table{};
    table.name = "predicted-share";
    table.source = "Prattichizzo, Pacchierotti and Rosati 2012, future work";
    table.capabilities = THIMBLE_AT_ONCE;
    table.keys = kShareKeys.data();
    table.key_count = static_cast<std::uint32_t>(kShareKeys.size());
    table.hand_share = [](const thimble_controller_settings*) { return 0.0; };
    return with_memory<PredictedShareEnd>(with_handle<PredictedShareEnd>(table));
}

}  // namespace

const thimble_controller& adaptive_fixture_controller() {
    static const thimble_controller kTable = adaptive_fixture_table();
    return kTable;
}

const thimble_controller& predicted_share_controller() {
    static const thimble_controller kTable = predicted_share_table();
    return kTable;
}

}  // namespace thimble
