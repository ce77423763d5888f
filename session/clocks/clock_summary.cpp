#include "session/clocks/clock_summary.hpp"

#include <algorithm>
#include <vector>

#include "session/clocks/clock_filter.hpp"
#include "session/clocks/clock_line.hpp"

namespace thimble {
namespace {

// Enough for a median; each costs a search along the hulls.
constexpr std::size_t kOneWaySamples = 501;

double median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

void add_one_way(std::span<const ClockExchange> exchanges, const ClockLine& line, ClockSummary& summary) {
    std::vector<double> there_s, back_s;
    double bound_s = 0;
    const std::size_t stride = exchanges.size() / kOneWaySamples + 1;
    for (std::size_t i = 0; i < exchanges.size(); i += stride) {
        const ClockExchange& e = exchanges[i];
        const OffsetInterval sent = line.at(e.sent), answered = line.at(e.answered);
        there_s.push_back(to_seconds(e.high()) - sent.offset_s());
        back_s.push_back(answered.offset_s() - to_seconds(e.low()));
        bound_s = std::max({bound_s, sent.bound_s(), answered.bound_s()});
    }
    summary.there = OneWayDelay{median(there_s), bound_s};
    summary.back = OneWayDelay{median(back_s), bound_s};
}

}  // namespace

bool ClockSummary::rate_known() const {
    return even && rate_low > -kClockRateLimit && rate_high < kClockRateLimit;
}

ClockSummary summarize_clock(std::span<const ClockExchange> exchanges) {
    ClockSummary summary;
    summary.exchanges = exchanges.size();
    if (exchanges.empty()) return summary;
    ClockFilter filter;
    std::size_t first = 0;
    std::vector<double> round_trips_s;
    for (std::size_t i = 0; i < exchanges.size(); ++i) {
        if (!filter.add(exchanges[i])) first = i;
        round_trips_s.push_back(to_seconds(exchanges[i].round_trip()));
    }
    summary.round_trip_median_s = median(round_trips_s);
    summary.steps = filter.steps();
    summary.offset = filter.at(exchanges.back().answered);
    const auto since_step = exchanges.subspan(first);
    const auto line = ClockLine::fit(since_step);
    if (!line) return summary;
    summary.even = true;
    summary.rate_low = line->rate_low();
    summary.rate_high = line->rate_high();
    summary.offset = line->at(exchanges.back().answered);
    add_one_way(since_step, *line, summary);
    return summary;
}

std::vector<NodeClock> clocks_of(double delay_s, const std::vector<ClockRecord>& records) {
    std::vector<NodeClock> clocks;
    for (const Role role : {Role::kMaster, Role::kSlaveSim, Role::kCutaneous, Role::kVisual, Role::kNetem}) {
        std::vector<ClockExchange> exchanges;
        for (const ClockRecord& record : records) {
            if (record.node == role) exchanges.push_back(record.exchange);
        }
        if (!exchanges.empty()) clocks.push_back({delay_s, role, summarize_clock(exchanges)});
    }
    return clocks;
}

}  // namespace thimble
