// Velocity of a sampled, quantised position. Five methods behind one contract:
//
//   the velocity is the slope of the smooth position between two samples,  v_k = (y_k - y_{k-1}) / dt,
//
// which a first-order hold along y relies on: a needle that moves from one smooth position to the next moves with
// exactly the estimated velocity. dt is the true distance between two samples, so lost and late samples do no
// harm. How y follows the samples, its lag and what one quantum does stand in each method's header;
// docs/speed.md compares them.
#pragma once

#include <array>
#include <chrono>
#include <cmath>
#include <string_view>
#include <variant>

#include "common/time.hpp"
#include "common/velocity/velocity_methods.hpp"

namespace thimble {

enum class VelocityMethod { kLowPass, kRaw, kWindowed, kFoaw, kKalman };

// As configuration files name them, in the order of VelocityMethod.
inline constexpr std::array<std::string_view, 5> kVelocityMethodNames{"low_pass", "raw", "windowed", "foaw",
                                                                      "kalman"};

struct VelocitySettings {
    VelocityMethod method = VelocityMethod::kKalman;        // why: docs/speed.md
    Duration time_constant = std::chrono::milliseconds{5};  // low_pass; >= 0
    Duration window = std::chrono::milliseconds{20};        // windowed; foaw: the longest; > 0
    FoawFit fit = FoawFit::kBest;                           // foaw
    double quantum_m = 3e-5;                                // of the position; foaw's band, kalman; > 0
    double acceleration_noise_m2_per_s3 = 3e-4;             // kalman; > 0
    Duration sample_period = std::chrono::milliseconds{1};  // kalman's nominal step; > 0
};

class VelocityEstimator {
  public:
    struct Estimate {
        double velocity_m_per_s = 0;
        double position_estimate_m = 0;
    };

    explicit VelocityEstimator(const VelocitySettings& settings = {}) : method_(make_method(settings)) {}

    // At rest at this position. The next sample only starts the clock.
    void reset(double position_m) {
        std::visit([&](auto& method) { method.reset(position_m); }, method_);
        estimate_ = {0, position_m};
        placed_ = true;
        started_ = false;
    }

    // A sample that is not later than the one before, or not a number, changes nothing.
    Estimate update(SessionTime now, double position_m) {
        if (!std::isfinite(position_m)) return estimate_;
        if (!placed_) reset(position_m);
        if (!started_) {
            started_ = true;
            last_ = now;
            return estimate_;
        }
        if (now <= last_) return estimate_;
        const Duration step = now - last_;
        last_ = now;
        const double before_m = estimate_.position_estimate_m;
        estimate_.position_estimate_m =
            std::visit([&](auto& method) { return method.advance(step, position_m); }, method_);
        // From the rounded positions, so that position and velocity agree to the last bit that matters.
        estimate_.velocity_m_per_s = (estimate_.position_estimate_m - before_m) / to_seconds(step);
        return estimate_;
    }

  private:
    using Method = std::variant<LowPassVelocity, RawVelocity, WindowedVelocity, FoawVelocity, KalmanVelocity>;
    static Method make_method(const VelocitySettings& s) {
        switch (s.method) {
            case VelocityMethod::kRaw:
                return RawVelocity{};
            case VelocityMethod::kWindowed:
                return WindowedVelocity{s.window};
            case VelocityMethod::kFoaw:
                return FoawVelocity{s.fit, s.window, s.quantum_m};
            case VelocityMethod::kKalman:
                return KalmanVelocity{s.acceleration_noise_m2_per_s3, s.quantum_m, s.sample_period};
            case VelocityMethod::kLowPass:
                break;
        }
        return LowPassVelocity{s.time_constant};
    }

    Method method_;
    Estimate estimate_;
    SessionTime last_{};
    bool placed_ = false;   // the position is known
    bool started_ = false;  // the time is known
};

}  // namespace thimble
