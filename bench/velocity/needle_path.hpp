// Needles whose position and velocity are known at every time, and what an encoder sees of them.
// Everything at the needle: 3 x the hand.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "common/random.hpp"
#include "common/time.hpp"

namespace thimble {

inline constexpr double kTremor_Hz = 10;  // the middle of the physiological band

struct NeedleState {
    double position_m;
    double velocity_m_per_s;
};

using NeedlePath = std::function<NeedleState(double time_s)>;

NeedlePath line(double start_m, double velocity_m_per_s);

// A x sin(2 pi f t) about `centre_m`.
NeedlePath oscillation(double centre_m, double amplitude_m, double frequency_Hz);

// Rest, in by `depth_m` with minimum jerk in `move_s`, hold, and out the same way; a tremor all the while.
// T. Flash and N. Hogan, "The coordination of arm movements", J. Neuroscience 5(7), 1985.
struct Reach {
    double start_m = 0;
    double depth_m = 0.1;
    double rest_s = 0.5;
    double move_s = 2;  // 94 mm/s at most
    double hold_s = 1;
    double tremor_m = 1.5e-4;  // rms: 0.05 mm at the hand, two frequencies of equal power
    double duration_s() const { return 2 * rest_s + 2 * move_s + hold_s; }
};
NeedlePath reach(const Reach& reach);

struct NeedleEncoder {
    double quantum_m = 3e-5;  // 0.01 mm at the hand
    Duration period = std::chrono::milliseconds{1};
    Duration jitter{};  // samples are this much early or late at most
};

struct SampledNeedle {
    std::vector<SessionTime> times;
    std::vector<NeedleState> truth;  // at those times
    std::vector<double> encoder_m;
};

SampledNeedle sample(const NeedlePath& path, double duration_s, const NeedleEncoder& encoder,
                     RandomStream& random);

}  // namespace thimble
