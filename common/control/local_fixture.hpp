// Model-mediated: what travels is not the force but what it says about the fixture. The handle renders a spring of its own, at
// once, where the feedback says the fixture is (in the manner of Hannaford 1989; Mitra and Niemeyer 2008).
//
// Estimator: pairs (x, F) of the same instant come back, whatever the delay, and in contact F = K (x - z). K and z by least
// squares with exponential forgetting of `memory` pairs:
//     K = cov(x, F) / var(x) within [1, stiffest],   z = mean x - mean F / K
// As long as the pairs span less than `span` K stays where it was, stiffness_N_per_m at first. The first contact is felt one
// delay late; the rendered plane then starts at the hand and moves to its estimate no faster than shift_m_per_s, so that no
// estimate, however wrong, throws the hand: it gives at most force limit x shift_m_per_s of power. Not passive beyond that:
// K h / 2 must be below the hand's damping. Pairs beyond the plane without force take it away again.
// SI units, frame: hand; F positive pushes the hand out.
#pragma once

namespace thimble {

struct LocalFixtureSettings {
    double stiffness_N_per_m = 3000;  // before there is an estimate
    double stiffest_N_per_m = 9000;   // > 0
    double memory = 200;              // pairs, >= 1
    double span_m = 1e-4;             // > 0; a few steps of the encoder
    double shift_m_per_s = 0.02;      // > 0
    double lost_m = 2e-3;             // so far beyond the plane without force: the fixture is gone
    double sample_period_s = 1e-3;
};

class LocalFixture {
  public:
    explicit LocalFixture(const LocalFixtureSettings& settings);
    void reset();

    // A pair from the feedback. Values that are no number are left out.
    void learn(double position_hand_m, double force_N);
    // The spring's force with the hand here; once per sample.
    double force_N(double position_hand_m);

    bool known() const { return known_; }
    double stiffness_N_per_m() const { return stiffness_N_per_m_; }
    double position_m() const { return position_m_; }  // estimated
    double rendered_m() const { return rendered_m_; }  // where the plane is on its way there

  private:
    struct Means {
        double weight = 0, x_m = 0, force_N = 0;
        double var_m2 = 0, cov_N_m = 0;  // about the means, times weight
    };
    void add(double x_m, double force_N);
    void forget() {
        known_ = rendered_ = false;
        means_ = {};
    }

    LocalFixtureSettings settings_;
    Means means_;
    bool known_ = false, rendered_ = false;
    double stiffness_N_per_m_, position_m_ = 0, rendered_m_ = 0;
};

}  // namespace thimble
