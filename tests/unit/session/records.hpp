// Synthetic trials whose metrics are known by construction.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "session/records/trial_record.hpp"
#include "tests/read_text.hpp"
#include "tests/refusal.hpp"

namespace thimble {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kFixture_m = 0.125;
inline constexpr double kPuncture_s = 1.0;
inline constexpr double kContact_s = 2.0;
inline constexpr double kBeep_s = 7.0;

// 1 kHz to `end_s`: in the tissue from 1 s, at the fixture from 2 s, where `penetration_m(time since
// contact)` says how deep; beep at 7 s.
inline TrialRecord make_record(const std::function<double(double)>& penetration_m, double end_s = 8.0) {
    TrialRecord record;
    record.conditions.fixture_position_m = kFixture_m;
    record.beep_time_s = kBeep_s;
    record.reason = EndReason::kCompleted;
    const int n = static_cast<int>(std::lround(end_s * 1000)) + 1;
    for (int i = 0; i < n; ++i) {
        TrajectorySample sample;
        sample.time_s = i / 1000.0;
        const double contact_s = (i - 2000) / 1000.0;
        sample.position_needle_m = contact_s < 0 ? 0.05 : kFixture_m + penetration_m(contact_s);
        sample.position_surface_m = 0.02;
        sample.phase = i >= 1000 ? TissuePhase::kPenetrated : TissuePhase::kFree;
        record.samples.push_back(sample);
    }
    return record;
}

inline TrialRecord sine_record(double mean_m, double amplitude_m, double frequency_Hz) {
    return make_record([=](double time_s) {
        return mean_m + amplitude_m * std::cos(2 * std::numbers::pi * frequency_Hz * time_s);
    });
}

}  // namespace thimble
