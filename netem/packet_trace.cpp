#include "netem/packet_trace.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace thimble {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

std::int64_t period_of(const std::vector<TraceRow>& rows, TraceBy by) {
    const std::int64_t last = rows.back().at;
    if (rows.size() == 1) return last + (by == TraceBy::kPacket ? 1 : kSecond_ns);
    return last + (last - rows[rows.size() - 2].at);
}

// The first row holds before its position, too, and the last one until the trace begins again.
double mean_of(const PacketTrace& trace, double (*value)(const TraceRow&)) {
    const std::vector<TraceRow>& rows = trace.rows();
    const TraceLayout& layout = trace.layout();
    const bool linear = layout.between == TraceBetween::kLinear;
    const TraceRow& behind = layout.end == TraceEnd::kWrap ? rows.front() : rows.back();
    double sum = static_cast<double>(rows.front().at) * value(rows.front());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const bool last = i + 1 == rows.size();
        const TraceRow& next = last ? behind : rows[i + 1];
        const double mean = linear ? (value(rows[i]) + value(next)) / 2 : value(rows[i]);
        sum += static_cast<double>((last ? trace.period() : next.at) - rows[i].at) * mean;
    }
    return sum / static_cast<double>(trace.period());
}

TraceRow between(const TraceRow& a, const TraceRow& b, double share) {
    TraceRow row = a;
    row.delay += Duration{std::llround(share * static_cast<double>((b.delay - a.delay).count()))};
    row.loss += share * (b.loss - a.loss);
    row.bits_per_s += share * (b.bits_per_s - a.bits_per_s);
    return row;
}

}  // namespace

PacketTrace::PacketTrace(std::vector<TraceRow> rows, const TraceLayout& layout)
    : rows_(std::move(rows)), layout_(layout), period_(0), mean_delay_ns_(0), mean_loss_(0) {
    assert(!rows_.empty() && rows_.front().at >= 0);
    assert(std::adjacent_find(rows_.begin(), rows_.end(), [](const TraceRow& a, const TraceRow& b) {
               return a.at >= b.at;
           }) == rows_.end());
    assert(std::all_of(rows_.begin(), rows_.end(), [&](const TraceRow& row) {
        return row.delay >= Duration::zero() && row.loss >= 0 && row.loss <= 1 &&
               (row.bits_per_s > 0 || !layout_.has_rate);
    }));
    period_ = period_of(rows_, layout_.by);
    mean_delay_ns_ =
        mean_of(*this, [](const TraceRow& row) { return static_cast<double>(row.delay.count()); });
    mean_loss_ = mean_of(*this, [](const TraceRow& row) { return row.loss; });
}

TraceRow PacketTrace::at(std::int64_t position) const {
    if (layout_.end == TraceEnd::kWrap) position %= period_;
    const auto after = std::upper_bound(rows_.begin(), rows_.end(), position,
                                        [](std::int64_t p, const TraceRow& row) { return p < row.at; });
    if (after == rows_.begin()) return rows_.front();
    const TraceRow& row = *std::prev(after);
    if (layout_.between == TraceBetween::kHold) return row;
    const bool at_end = after == rows_.end();
    if (at_end && layout_.end == TraceEnd::kHold) return row;
    const TraceRow& next = at_end ? rows_.front() : *after;
    const std::int64_t next_at = at_end ? period_ : after->at;
    return between(row, next, static_cast<double>(position - row.at) / static_cast<double>(next_at - row.at));
}

}  // namespace thimble
