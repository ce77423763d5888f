#include "cutaneous_node/fingertip/pad_model.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace thimble {

double PadModel::elastic_N(double indentation_m) const {
    if (!(indentation_m > 0)) return 0;
    return parameters_.scale_N * std::expm1(parameters_.exponent_per_m * indentation_m);
}

double PadModel::indentation_m(double elastic_N) const {
    return std::log1p(std::max(elastic_N, 0.0) / parameters_.scale_N) / parameters_.exponent_per_m;
}

// Exact for an elastic force that changes evenly over the step.
double PadModel::advance(double indentation_m, double step_s) {
    assert(step_s > 0);
    if (step_s != step_s_) {
        step_s_ = step_s;
        for (std::size_t k = 0; k < memory_N_.size(); ++k) {
            const double steps = step_s / parameters_.relaxation_s[k];
            decay_[k] = std::exp(-steps);
            mean_decay_[k] = -std::expm1(-steps) / steps;
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

}  // namespace thimble
