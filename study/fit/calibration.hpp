// Simulation-based calibration of a fit: people are drawn from the population, do their trials, and are fitted. Where the fit is
// right, the rank of each true value among the draws is uniform. S. Talts and others, "Validating Bayesian inference algorithms with
// simulation-based calibration", arXiv 1804.06788, 2018.
#pragma once

#include <string>
#include <vector>

#include "study/fit/operator_model.hpp"

namespace thimble {

struct KeyCalibration {
    std::string key;
    double p_uniform = 0;  // chi squared over ten classes of ranks
    double coverage = 0;   // share of people whose value lies in the 90 % interval
    double narrowed = 0;   // mean of 1 - posterior SD / population SD, of the logarithm
};

// People r = 0 ... `people` - 1 do the trials of the model's groups on `jobs` threads.
std::vector<KeyCalibration> calibrate(const SystemSettings& settings, const OperatorModel& model,
                                      std::uint64_t seed, std::size_t people, unsigned jobs);

}  // namespace thimble
