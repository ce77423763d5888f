// This machine's clock as chrony reports it, if chrony runs. Nothing here needs it: offsets are measured.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace thimble {

struct ChronyTracking {
    std::string reference;  // address or name of the source
    unsigned stratum = 0;
    double last_offset_s = 0;
    double root_dispersion_s = 0;
};

// One line of `chronyc -n -c tracking`; none if it is not one.
std::optional<ChronyTracking> parse_chrony_tracking(std::string_view line);

// A sentence for reports, whether chrony is there or not. Runs chronyc.
std::string describe_chrony();
std::string describe(const ChronyTracking& tracking);

}  // namespace thimble
