// The table "Clocks" of a run's report.
#pragma once

#include <string>
#include <vector>

#include "analysis/text/html.hpp"
#include "session/clocks/clock_summary.hpp"

namespace thimble {

ReportTable clock_table(const std::vector<NodeClock>& clocks);

// "12.3", or "not known: +-40.1", in microseconds.
std::string one_way_text_us(const std::optional<OneWayDelay>& delay);
// "-0.12 to 3.40" in parts per million.
std::string rate_text_ppm(const ClockSummary& clock);

}  // namespace thimble
