// The measures of one trial. Definitions: the paper's measures (claims E1, E2, E3); penetration p =
// needle minus fixture position, positive beyond the fixture. A measure that does not exist in a trial is
// NaN.
#pragma once

#include <cstdint>
#include <limits>

#include "session/records/trial_record.hpp"

namespace thimble {

// The hold is watched for oscillation from this long after the first contact: arriving is no oscillation.
inline constexpr double kHoldSettling_s = 0.5;
// Class "oscillates": the needle leaves the fixture at least twice AND moves by more than 1 mm rms during the
// hold. Both are needed: a hand's sway is about 0.75 mm at the needle, so that alone can neither pass the rms
// bound nor, at the millimetres of overshoot without kinesthetic feedback, leave the fixture; a single slip
// is no oscillation.
inline constexpr std::uint32_t kOscillationContactsLost = 2;
inline constexpr double kOscillationRms_m = 1e-3;
// Least half-width of the band around the mean that a crossing must span: three encoder steps at the needle
// (0.03 mm each), so that quantisation is not counted as a frequency.
inline constexpr double kCrossingHysteresis_m = 0.09e-3;
// Span before the fixture's removal whose mean penetration the peak displacement starts from (experiment 2).
inline constexpr double kBeforeRemoval_s = 5.0;

struct TrialMetrics {
    static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

    // Over samples in contact (p > 0, fixture present), first contact to beep; without a beep to the trial's
    // end.
    double penetration_mean_m = kNone;
    double penetration_max_m = kNone;
    double completion_time_s = kNone;    // first puncture of the tissue to the beep
    double peak_displacement_m = kNone;  // max p after the fixture's removal minus mean p of the 5 s before
    // Of the needle about its own mean, during the hold.
    double oscillation_rms_m = kNone;
    double oscillation_peak_to_peak_m = kNone;
    double oscillation_frequency_Hz = kNone;  // NaN with fewer than two upward crossings of the mean
    double puncture_time_s = kNone;
    double first_contact_time_s = kNone;
    double duration_s = kNone;        // of the whole trial, withdrawal included
    std::uint32_t contacts_lost = 0;  // between first contact and beep
    bool beeped = false;
    bool oscillates = false;
};

// Samples in order of time, finite; any number of them, also none.
TrialMetrics measure(const TrialRecord& record);

}  // namespace thimble
