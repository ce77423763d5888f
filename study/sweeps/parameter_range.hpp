// Parameters that are varied: which, from where to where.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "session/settings/system_settings.hpp"

namespace thimble {

// Two keys for one value vary together (the fingertip device's limit, and the limit that the operator expects).
struct ParameterRange {
    std::vector<std::string> keys;  // dotted, of the session file; at least one
    double low = 0;                 // SI, low < high
    double high = 0;
    unsigned points = 0;  // of a scan; 0: none was given

    const std::string& name() const { return keys.front(); }
    double at(unsigned point) const;    // of `points` >= 2, evenly spaced, both ends
    double within(double share) const;  // share in [0, 1)
    void set(std::vector<SettingChange>& changes, double value) const;
};

// `text` is as "operator.criterion_N=1:4" or "operator.criterion_N=1:4:7". A documented range changes all its keys.
// Throws Error (usage) that says what is wrong.
ParameterRange parse_parameter_range(std::string_view text);

// Parameters of operator and rig whose values no source fixes, or fixes only within a range. Not all there are:
// those that may move a claim.
const std::vector<ParameterRange>& documented_ranges();

}  // namespace thimble
