// The features of one trial that a fit compares: seven logarithms of times, depths and speeds of the needle. No number depends on where
// the fixture was.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "session/records/trial_record.hpp"

namespace thimble {

inline constexpr std::array<std::string_view, 7> kFeatureNames{
    "speed",       // of the insertion, before the contact with the fixture
    "slowing",     // from the touch of the tissue until the needle slows down
    "depth",       // of the penetration of the fixture, mean from one second after the contact to the beep
    "stopping",    // from the contact to nine tenths of that depth
    "wander",      // rms about that mean
    "tremble",     // rms of the movement within 50 ms
    "withdrawal",  // from the beep until the needle moves out
};
using TrialFeatures = std::array<double, kFeatureNames.size()>;

// Nothing of a trial that lacks a puncture, a contact, a beep or the samples around them. Samples in order of time.
std::optional<TrialFeatures> trial_features(std::span<const TrajectorySample> samples,
                                            double fixture_position_m, double beep_time_s);

}  // namespace thimble
