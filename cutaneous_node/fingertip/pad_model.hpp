// The pulp of a finger under a flat platform, quasi-linear viscoelastic (Fung) with an exponential elastic force, as Pawluk and
// Howe ("Dynamic lumped element response of the human fingerpad", 1999) found it for 0 to 2 N, with their relaxation times of
// about 4 ms, 70 ms and 1.4 s:
//   F_e(x) = b (exp(m x) - 1),   F(t) = c_inf F_e(t) + sum_k c_k int exp(-(t - s) / tau_k) dF_e(s),   c_inf + sum c_k = 1
// b, m and the shares c are assumptions: 0.4 to 0.8 N/mm between 0.5 and 1 N.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>

#include "common/math/portable.hpp"

namespace thimble {

struct PadParameters {
    double scale_N = 0.1;         // b
    double exponent_per_m = 700;  // m
    std::array<double, 3> relaxation_s{0.004, 0.070, 1.4};
    std::array<double, 3> shares{0.2, 0.2, 0.2};
};

class PadModel {
  public:
    explicit PadModel(const PadParameters& parameters = {}) : parameters_(parameters) {}

    // Elastic part: before anything relaxes. Indentation in m, positive into the pad; outside it no force.
    double elastic_N(double indentation_m) const {
        if (!(indentation_m > 0)) return 0;
        return parameters_.scale_N * portable::expm1(parameters_.exponent_per_m * indentation_m);
    }

    // Its inverse, force >= 0.
    double indentation_m(double elastic_N) const {
        return portable::log1p(std::max(elastic_N, 0.0) / parameters_.scale_N) / parameters_.exponent_per_m;
    }

    // The force after `step_s` > 0 in which the elastic force has changed evenly to that of `indentation_m`; >= 0: the platform
    // does not stick.
    // Exact for an elastic force that changes evenly over the step.
    double advance(double indentation_m, double step_s) {
        assert(step_s > 0);
        if (step_s != step_s_) {
            step_s_ = step_s;
            for (std::size_t k = 0; k < memory_N_.size(); ++k) {
                const double steps = step_s / parameters_.relaxation_s[k];
                decay_[k] = portable::exp(-steps);
                mean_decay_[k] = -portable::expm1(-steps) / steps;
            }
        }
        const double elastic_now_N = elastic_N(indentation_m);
        const double change_N = elastic_now_N - elastic_before_N_;
        elastic_before_N_ = elastic_now_N;
        double rest = 1, sum_N = 0;
        for (std::size_t k = 0; k < memory_N_.size(); ++k) {
            memory_N_[k] = memory_N_[k] * decay_[k] + parameters_.shares[k] * change_N * mean_decay_[k];
            sum_N += memory_N_[k];
            rest -= parameters_.shares[k];
        }
        force_N_ = std::max(rest * elastic_now_N + sum_N, 0.0);
        return force_N_;
    }

    double force_N() const { return force_N_; }

  private:
    PadParameters parameters_;
    double elastic_before_N_ = 0;
    double force_N_ = 0;
    std::array<double, 3> memory_N_{};
    // exp(-step/tau) and the mean of it over the step, of the last step's length.
    double step_s_ = 0;
    std::array<double, 3> decay_{}, mean_decay_{};
};

}  // namespace thimble
