#include "visual_node/views/monitor_history.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace thimble {
namespace {

constexpr double kMonitorRate_Hz = 250;
constexpr double kLeastStep_s = 0.95 / kMonitorRate_Hz;  // at a replay's full speed none is left out
constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();

double value_of(Quantity quantity, const Monitor& monitor) {
    const bool timed = monitor.one_way_s >= 0;
    switch (quantity) {
        case Quantity::kNeedle_m:
            return monitor.position_needle_m;
        case Quantity::kSurface_m:
            return monitor.position_surface_m;
        case Quantity::kFixture_m:
            return monitor.fixture_present ? monitor.position_fixture_m : kNotKnown;
        case Quantity::kForceTotal_N:
            return -monitor.force_total_N;
        case Quantity::kForceHand_N:
            return monitor.force_hand_N;
        case Quantity::kRoundTrip_s:
            return monitor.round_trip_s > 0 ? monitor.round_trip_s : kNotKnown;
        case Quantity::kOneWay_s:
            return timed ? monitor.one_way_s : kNotKnown;
        case Quantity::kOneWayLow_s:
            return timed ? std::max(0.0, monitor.one_way_s - monitor.one_way_bound_s) : kNotKnown;
        case Quantity::kOneWayHigh_s:
            return timed ? monitor.one_way_s + monitor.one_way_bound_s : kNotKnown;
        case Quantity::kEnergy_J:
            return monitor.energy_in_J;
        case Quantity::kCount:
            break;
    }
    return kNotKnown;
}

void put(Column& column, double value, bool joined) {
    if (!column.present) column = {value, value, value, true, joined};
    column.low = std::min(column.low, value);
    column.high = std::max(column.high, value);
    column.last = value;
}

// Fills the columns between two neighbouring samples with the line that joins them.
void join(std::span<Column> columns, std::size_t from, std::size_t to, double value) {
    const double step = (value - columns[from].last) / static_cast<double>(to - from);
    for (std::size_t i = from + 1; i < to; ++i) {
        put(columns[i], columns[from].last + step * static_cast<double>(i - from), true);
    }
}

}  // namespace

MonitorHistory::MonitorHistory(double window_s)
    : window_s_(window_s), samples_(static_cast<std::size_t>((window_s + 1) * kMonitorRate_Hz)) {
    assert(window_s > 0);
}

void MonitorHistory::add(SessionTime now, std::uint32_t trial, const Monitor& monitor, bool replay) {
    if (trial != trial_ || (size() > 0 && monitor.time_s < newest_s_)) clear();
    trial_ = trial;
    const bool again = size() > 0 && monitor.time_s == newest_s_;
    running_ = monitor.state == NodeState::kRunning && !(replay && again);
    const bool begun = running_ || monitor.time_s > 0;
    if (!begun || again) return;
    newest_s_ = monitor.time_s;
    advanced_ = now;
    // A slow replay has more messages per second of its trial than the ring has room for.
    if (replay && size() > 0 && newest_s_ - samples_.back().time_s < kLeastStep_s) return;
    Sample sample{monitor.time_s};
    for (std::size_t i = 0; i < kQuantityCount; ++i)
        sample.values[i] = value_of(static_cast<Quantity>(i), monitor);
    samples_.push_back(sample);
}

double MonitorHistory::end_s(SessionTime now) const {
    if (size() == 0) return 0;
    return running_ ? newest_s_ + std::max(0.0, to_seconds(now - advanced_)) : newest_s_;
}

void MonitorHistory::decimate(Quantity quantity, double begin_s, double column_s,
                              std::span<Column> columns) const {
    assert(column_s > 0);
    std::fill(columns.begin(), columns.end(), Column{});
    std::size_t before = columns.size();  // column of the sample before; none
    double before_s = 0;
    auto sample = std::partition_point(samples_.begin(), samples_.end(),
                                       [&](const Sample& one) { return one.time_s < begin_s; });
    for (; sample != samples_.end(); ++sample) {
        const double time_s = sample->time_s, value = sample->values[static_cast<std::size_t>(quantity)];
        const double place = std::floor((time_s - begin_s) / column_s);
        if (place >= static_cast<double>(columns.size())) break;
        if (std::isnan(value)) {
            before = columns.size();
            continue;
        }
        const auto column = static_cast<std::size_t>(std::max(place, 0.0));
        const bool joined = before < columns.size() && time_s - before_s <= kMonitorGap_s;
        if (joined) join(columns, before, column, value);
        put(columns[column], value, joined);
        before = column;
        before_s = time_s;
    }
}

double column_begin(double end_s, double column_s, std::size_t columns) {
    return (std::floor(end_s / column_s) + 1 - static_cast<double>(columns)) * column_s;
}

}  // namespace thimble
