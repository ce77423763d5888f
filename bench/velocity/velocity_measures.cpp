#include "bench/velocity/velocity_measures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

constexpr std::array kSpeeds_m_per_s{0.002, 0.005, 0.010, 0.020, 0.060, 0.100};
constexpr double kSettle_s = 1;
constexpr double kMeasure_s = 1;
constexpr double kTremorAmplitude_m = 1.5e-4 * std::numbers::sqrt2;

using Estimates = std::vector<VelocityEstimator::Estimate>;

struct Squares {
    double sum = 0;
    std::size_t count = 0;
    void add(double value) {
        sum += value * value;
        ++count;
    }
    double rms() const { return std::sqrt(sum / static_cast<double>(count)); }
};

void measure_noise(const VelocitySettings& settings, const VelocityStudy& study, VelocityQuality& quality) {
    RandomStream random = study.random(1);
    Squares noise;
    for (const double nominal : kSpeeds_m_per_s) {
        for (int i = 0; i < study.repeats; ++i) {
            // Not quite the nominal speed: round ones meet the quanta in lockstep.
            const double speed = nominal * random.uniform(0.95, 1.05);
            const NeedlePath path = line(random.uniform(0, study.encoder.quantum_m), speed);
            const SampledNeedle needle = sample(path, kSettle_s + kMeasure_s, study.encoder, random);
            const Estimates estimates = estimate(settings, needle);
            const auto settled = static_cast<std::size_t>(kSettle_s / to_seconds(study.encoder.period));
            for (std::size_t k = settled; k < estimates.size(); ++k) {
                const double error = estimates[k].velocity_m_per_s - speed;
                noise.add(error);
                quality.noise_peak_m_per_s = std::max(quality.noise_peak_m_per_s, std::abs(error));
            }
        }
    }
    quality.noise_rms_m_per_s = noise.rms();
}

// RMS of the estimate against the truth `lag_s` earlier.
double lagged_error(const SampledNeedle& needle, const Estimates& estimates, const NeedlePath& path,
                    double lag_s) {
    Squares error;
    for (std::size_t k = 0; k < estimates.size(); ++k) {
        const double time_s = to_seconds(needle.times[k] - needle.times[0]);
        error.add(estimates[k].velocity_m_per_s - path(time_s - lag_s).velocity_m_per_s);
    }
    return error.rms();
}

// The error has one minimum within these bounds, for lags far below half a period of the tremor.
double best_lag_s(const SampledNeedle& needle, const Estimates& estimates, const NeedlePath& path) {
    double low_s = -0.010, high_s = 0.040;
    while (high_s - low_s > 1e-6) {
        const double third_s = (high_s - low_s) / 3;
        const bool left = lagged_error(needle, estimates, path, low_s + third_s) <
                          lagged_error(needle, estimates, path, high_s - third_s);
        (left ? high_s : low_s) += left ? -third_s : third_s;
    }
    return (low_s + high_s) / 2;
}

void measure_lag(const VelocitySettings& settings, const VelocityStudy& study, VelocityQuality& quality) {
    RandomStream random = study.random(2);
    Reach shape;
    shape.start_m = random.uniform(0, study.encoder.quantum_m);
    const NeedlePath path = reach(shape);
    NeedleEncoder encoder = study.encoder;
    const SampledNeedle needle = sample(path, shape.duration_s(), encoder, random);
    const Estimates estimates = estimate(settings, needle);
    quality.lag_s = best_lag_s(needle, estimates, path);
    quality.residual_rms_m_per_s = lagged_error(needle, estimates, path, quality.lag_s);
    quality.error_rms_m_per_s = lagged_error(needle, estimates, path, 0);
}

}  // namespace

Estimates estimate(const VelocitySettings& settings, const SampledNeedle& needle) {
    VelocityEstimator estimator(settings);
    estimator.reset(needle.encoder_m.front());
    Estimates estimates;
    estimates.reserve(needle.times.size());
    for (std::size_t k = 0; k < needle.times.size(); ++k) {
        estimates.push_back(estimator.update(needle.times[k], needle.encoder_m[k]));
    }
    return estimates;
}

VelocityQuality measure_quality(const VelocitySettings& settings, const VelocityStudy& study) {
    VelocityQuality quality;
    measure_noise(settings, study, quality);
    measure_lag(settings, study, quality);
    return quality;
}

TremorResponse measure_tremor(const VelocitySettings& settings, const VelocityStudy& study) {
    RandomStream random = study.random(3);
    const double rate = 2 * std::numbers::pi * kTremor_Hz;
    const double true_peak = kTremorAmplitude_m * rate;
    double in_phase = 0, behind = 0;
    Squares rest;
    for (int i = 0; i < study.repeats; ++i) {
        const NeedlePath path =
            oscillation(random.uniform(0, study.encoder.quantum_m), kTremorAmplitude_m, kTremor_Hz);
        const SampledNeedle needle = sample(path, kSettle_s + kMeasure_s, study.encoder, random);
        const Estimates estimates = estimate(settings, needle);
        const auto settled = static_cast<std::size_t>(kSettle_s / to_seconds(study.encoder.period));
        double cosine = 0, sine = 0, square = 0;
        const auto count = static_cast<double>(estimates.size() - 1 - settled);
        // A whole number of periods: the two components are orthogonal.
        for (std::size_t k = settled; k + 1 < estimates.size(); ++k) {
            const double angle = rate * to_seconds(needle.times[k] - needle.times[0]);
            const double velocity = estimates[k].velocity_m_per_s;
            cosine += 2 * velocity * std::cos(angle) / count;
            sine += 2 * velocity * std::sin(angle) / count;
            square += velocity * velocity / count;
        }
        in_phase += cosine / study.repeats;
        behind += sine / study.repeats;
        rest.add(std::sqrt(std::max(0.0, square - (cosine * cosine + sine * sine) / 2)));
    }
    return {std::hypot(in_phase, behind) / true_peak, std::atan2(behind, in_phase), rest.rms()};
}

double measure_cost_s(const VelocitySettings& settings, const VelocityStudy& study) {
    RandomStream random = study.random(4);
    const SampledNeedle needle = sample(reach({}), Reach{}.duration_s(), study.encoder, random);
    double best_s = std::numeric_limits<double>::infinity();
    double sum = 0;
    for (int run = 0; run < 20; ++run) {
        VelocityEstimator estimator(settings);
        estimator.reset(needle.encoder_m.front());
        const SessionTime start = wall_now();
        for (std::size_t k = 0; k < needle.times.size(); ++k) {
            sum += estimator.update(needle.times[k], needle.encoder_m[k]).velocity_m_per_s;
        }
        best_s = std::min(best_s, to_seconds(wall_now() - start) / static_cast<double>(needle.times.size()));
    }
    return std::isfinite(sum) ? best_s : sum;  // the sum is used, so the loop is not optimised away
}

}  // namespace thimble
