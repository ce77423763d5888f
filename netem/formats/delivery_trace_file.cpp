#include "netem/formats/delivery_trace_file.hpp"

#include <cstdint>
#include <vector>

#include <fmt/format.h>

#include "netem/formats/text_lines.hpp"

namespace thimble {
namespace {

constexpr std::size_t kMostOpportunities = 50'000'000;  // ten minutes at 1 Gbit/s
constexpr std::int64_t kLongest_ms = 86'400'000;        // a day

}  // namespace

DeliveryTrace parse_delivery_trace(std::string_view text, std::string_view name) {
    std::vector<std::uint32_t> times_ms;
    LineReader lines(text, name);
    while (lines.next()) {
        const std::string_view line = trimmed(lines.line());
        const auto time = parse_integer(line);
        if (!time || *time < 0 || *time > kLongest_ms) {
            lines.fail(fmt::format("'{}' is no whole number of milliseconds from 0 to {}", line.substr(0, 40),
                                   kLongest_ms));
        }
        if (!times_ms.empty() && *time < times_ms.back()) lines.fail("times must not fall");
        if (times_ms.size() == kMostOpportunities) {
            lines.fail(fmt::format("more than {} lines; split the trace", kMostOpportunities));
        }
        times_ms.push_back(static_cast<std::uint32_t>(*time));
    }
    if (times_ms.empty()) fail_at_line(name, 1, "is empty: a trace has a time in milliseconds per line");
    if (times_ms.back() == 0) lines.fail("the last time must be above 0: it is the trace's length");
    return DeliveryTrace(std::move(times_ms));
}

std::string print_delivery_trace(const DeliveryTrace& trace) {
    std::string text;
    for (const std::uint32_t time_ms : trace.times_ms()) text += fmt::format("{}\n", time_ms);
    return text;
}

}  // namespace thimble
