#include "session/clocks/chrony.hpp"

#include <cctype>
#include <charconv>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/process/child.hpp"

namespace thimble {
namespace {

// Of `chronyc -c tracking`: reference id, name, stratum, reference time, system time, last offset, RMS offset,
// frequency, residual frequency, skew, root delay, root dispersion, update interval, leap status.
constexpr std::size_t kFields = 14, kName = 1, kStratum = 2, kLastOffset = 5, kRootDispersion = 11;

std::vector<std::string_view> split_fields(std::string_view line) {
    std::vector<std::string_view> fields;
    for (std::size_t comma = line.find(','); comma != std::string_view::npos; comma = line.find(',')) {
        fields.push_back(line.substr(0, comma));
        line.remove_prefix(comma + 1);
    }
    fields.push_back(line);
    return fields;
}

template <class Number>
bool read_number(std::string_view text, Number& number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc{} && end == text.data() + text.size();
}

}  // namespace

std::optional<ChronyTracking> parse_chrony_tracking(std::string_view line) {
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back())) != 0) line.remove_suffix(1);
    const auto fields = split_fields(line);
    if (fields.size() != kFields) return std::nullopt;
    ChronyTracking tracking;
    tracking.reference = fields[kName];
    const bool numbers = read_number(fields[kStratum], tracking.stratum) &&
                         read_number(fields[kLastOffset], tracking.last_offset_s) &&
                         read_number(fields[kRootDispersion], tracking.root_dispersion_s);
    if (!numbers || !std::isfinite(tracking.last_offset_s) || !std::isfinite(tracking.root_dispersion_s))
        return std::nullopt;
    return tracking;
}

std::string describe(const ChronyTracking& tracking) {
    if (tracking.reference.empty()) return "chrony runs, but follows no source; not needed";
    return fmt::format("chrony follows {} (stratum {}), last offset {:+.1f} us, root dispersion {:.1f} us",
                       tracking.reference, tracking.stratum, 1e6 * tracking.last_offset_s,
                       1e6 * tracking.root_dispersion_s);
}

std::string describe_chrony() {
    try {
        const ProgramResult result = run_program("chronyc", {"-n", "-c", "tracking"}, ".", "");
        if (const auto tracking = parse_chrony_tracking(result.output)) return describe(*tracking);
        return "chronyc is installed, but its daemon gives no answer; not needed";
    } catch (const Error&) {
        return "no chrony here; not needed";
    }
}

}  // namespace thimble
