#include "analysis/report/clock_table.hpp"

#include <cmath>

#include <fmt/format.h>

#include "session/records/condition_summary.hpp"

namespace thimble {

std::string one_way_text_us(const std::optional<OneWayDelay>& delay) {
    if (!delay) return "not known";
    const double bound_us = 1e6 * delay->bound_s;
    if (!delay->known()) return fmt::format("not known: +-{:.1f}", bound_us);
    return fmt::format("{:.1f} +-{:.1f}", 1e6 * delay->median_s, bound_us);
}

std::string rate_text_ppm(const ClockSummary& clock) {
    if (!clock.even) return "not even";
    if (!clock.rate_known()) return "not known";
    return fmt::format("{:.2f} to {:.2f}", 1e6 * clock.rate_low, 1e6 * clock.rate_high);
}

ReportTable clock_table(const std::vector<NodeClock>& clocks) {
    ReportTable table;
    table.title = "Clocks";
    table.note =
        "Each node's clock minus the session's at the last exchange: surely within offset +- bound, whatever "
        "the network did. Rate: how fast the node's clock gains, all that the exchanges allow. Exchanges "
        "pass "
        "the control channel, not the emulated network; one-way delays are its own, shown where the bound is "
        "smaller than the value. Two nodes: difference of offsets, sum of bounds.";
    table.columns = {"condition", "node",  "offset, s", "bound, us", "rate, ppm",
                     "exchanges", "steps", "there, us", "back, us"};
    for (const NodeClock& clock : clocks) {
        const ClockSummary& s = clock.summary;
        table.rows.push_back({delay_text(clock.delay_s), to_string(clock.node),
                              fmt::format("{:.6f}", s.offset ? s.offset->offset_s() : std::nan("")),
                              fmt::format("{:.1f}", s.offset ? 1e6 * s.offset->bound_s() : std::nan("")),
                              rate_text_ppm(s), std::to_string(s.exchanges), std::to_string(s.steps),
                              one_way_text_us(s.there), one_way_text_us(s.back)});
    }
    return table;
}

}  // namespace thimble
