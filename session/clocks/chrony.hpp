// This machine's clock as chrony reports it, if chrony runs. Nothing here needs it: offsets are measured.
#pragma once

#include <cctype>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "common/decimal_text.hpp"
#include "common/error.hpp"
#include "common/process/child.hpp"
#include "netem/formats/text_lines.hpp"

namespace thimble {

struct ChronyTracking {
    std::string reference;  // address or name of the source
    unsigned stratum = 0;
    double last_offset_s = 0;
    double root_dispersion_s = 0;
};

// One line of `chronyc -n -c tracking`; none if it is not one.
inline std::optional<ChronyTracking> parse_chrony_tracking(std::string_view line) {
    // Of `chronyc -c tracking`: reference id, name, stratum, reference time, system time, last offset, RMS offset,
    // frequency, residual frequency, skew, root delay, root dispersion, update interval, leap status.
    constexpr std::size_t kFields = 14, kName = 1, kStratum = 2, kLastOffset = 5, kRootDispersion = 11;
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back())) != 0) line.remove_suffix(1);
    const auto fields = fields_of(line);
    if (fields.size() != kFields) return std::nullopt;
    const auto stratum = parse_whole<std::int64_t>(fields[kStratum]);
    const auto last_offset_s = parse_number(fields[kLastOffset]);
    const auto root_dispersion_s = parse_number(fields[kRootDispersion]);
    if (!stratum || *stratum < 0 || !last_offset_s || !root_dispersion_s) return std::nullopt;
    return ChronyTracking{std::string(fields[kName]), static_cast<unsigned>(*stratum), *last_offset_s,
                          *root_dispersion_s};
}

inline std::string describe(const ChronyTracking& tracking) {
    if (tracking.reference.empty()) return "chrony runs, but has no time source; one machine needs none";
    return fmt::format("chrony follows {} (stratum {}), last offset {:+.1f} us, root dispersion {:.1f} us",
                       tracking.reference, tracking.stratum, 1e6 * tracking.last_offset_s,
                       1e6 * tracking.root_dispersion_s);
}

// A sentence for reports, whether chrony is there or not. Runs chronyc.
inline std::string describe_chrony() {
    try {
        const ProgramResult result = run_program("chronyc", {"-n", "-c", "tracking"}, ".", "");
        if (const auto tracking = parse_chrony_tracking(result.output)) return describe(*tracking);
        return "chronyc is installed, but its daemon does not answer; one machine needs none";
    } catch (const Error&) {
        return "chrony is not installed; one machine needs none";
    }
}

}  // namespace thimble
