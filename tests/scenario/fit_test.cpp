// Fits of the virtual operator to itself: what was drawn for a person comes out of that person's trials.
#include <cstdlib>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "session/settings/protocol.hpp"
#include "study/fit/calibration.hpp"
#include "study/ordered_workers.hpp"

namespace thimble {
namespace {

std::size_t from_environment(const char* name, std::size_t otherwise) {
    const char* const text = std::getenv(name);
    return text != nullptr ? std::strtoul(text, nullptr, 10) : otherwise;
}

std::vector<std::optional<SimulatedPair>> train(const SystemSettings& settings,
                                                const std::vector<FitGroup>& groups, std::size_t pairs) {
    OrderedWorkers<std::optional<SimulatedPair>> workers(pairs, thread_count(0), [&](std::size_t i) {
        return simulate_pair(settings, training_pair(groups, 7, i));
    });
    std::vector<std::optional<SimulatedPair>> all;
    all.reserve(pairs);
    for (std::size_t i = 0; i < pairs; ++i) all.push_back(*workers.take());
    return all;
}

// tests/nightly/proofs raises both numbers: 1000 people, as Talts and others have it.
TEST(FitCalibration, RanksAreUniformAndIntervalsCover) {
    const std::size_t people = from_environment("THIMBLE_CALIBRATIONS", 30);
    const std::size_t trials = from_environment("THIMBLE_FIT_SIMULATIONS", 400);
    const SystemSettings settings;
    const auto groups = fit_groups(subject_trials(experiment_1(settings, 1, 1), 1));
    const OperatorModel model(settings.person, groups, train(settings, groups, trials / 2));
    std::size_t uniform = 0;
    for (const KeyCalibration& key : calibrate(settings, model, 3, people, thread_count(0))) {
        fmt::print("{:<42} P = {:.4f}, {:.1f} % in the 90 % interval, narrowed by {:.0f} %\n", key.key,
                   key.p_uniform, 100 * key.coverage, 100 * key.narrowed);
        uniform += key.p_uniform > 0.01;
    }
    EXPECT_GE(uniform, 8U);
}

}  // namespace
}  // namespace thimble
