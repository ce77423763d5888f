// A needle's path as people record or make it: CSV with the columns time_s and position_needle_m among any
// others, in any order. Read leniently where nothing can be mistaken (spreadsheets' semicolons and line ends, blanks around
// numbers, no newline at the end, lines from '#') and strictly everywhere else.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string_view>
#include <vector>

namespace thimble {

struct NeedlePath {
    struct Sample {
        double time_s;
        double position_m;
        std::size_t line;  // of the file, from 1
    };
    std::vector<Sample> samples;  // at least one, times strictly increasing
};

struct NeedleLimits {
    double longest_gap_s = 10;    // between two samples; what lies between is taken for a straight line
    double farthest_m = 10;       // from the origin
    double fastest_m_per_s = 10;  // no hand is faster; beyond, a unit is wrong
};

// Throws Error (data) that names file and line: a missing column, something that is no finite number, an
// empty field or line, times that do not increase, a gap, a needle out of reach or faster than any hand.
NeedlePath read_needle_path(const std::filesystem::path& file, const NeedleLimits& limits);
NeedlePath parse_needle_path(std::string_view text, std::string_view name, const NeedleLimits& limits);

}  // namespace thimble
