#include "visual_node/views/monitor_history.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace thimble {
namespace {

constexpr double kMonitorRate_Hz = 250;
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
            return monitor.force_total_N;
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
    : window_s_(window_s),
      capacity_(static_cast<std::size_t>((window_s + 1) * kMonitorRate_Hz)),
      times_s_(capacity_) {
    assert(window_s > 0);
    for (auto& ring : values_) ring.resize(capacity_);
}

void MonitorHistory::clear() { first_ = size_ = 0; }

void MonitorHistory::add(SessionTime now, std::uint32_t trial, const Monitor& monitor) {
    running_ = monitor.state == NodeState::kRunning;
    if (trial != trial_ || (size_ > 0 && monitor.time_s < times_s_[slot(size_ - 1)])) clear();
    trial_ = trial;
    const bool again = size_ > 0 && monitor.time_s == times_s_[slot(size_ - 1)];
    const bool begun = running_ || monitor.time_s > 0;
    if (begun && !again) push(now, monitor.time_s, monitor);
}

void MonitorHistory::push(SessionTime now, double time_s, const Monitor& monitor) {
    if (size_ == capacity_) {
        first_ = (first_ + 1) % capacity_;
    } else {
        ++size_;
    }
    const std::size_t newest = slot(size_ - 1);
    times_s_[newest] = time_s;
    for (std::size_t i = 0; i < kQuantityCount; ++i) {
        values_[i][newest] = value_of(static_cast<Quantity>(i), monitor);
    }
    advanced_ = now;
}

double MonitorHistory::end_s(SessionTime now) const {
    if (size_ == 0) return 0;
    const double newest_s = times_s_[slot(size_ - 1)];
    return running_ ? newest_s + std::max(0.0, to_seconds(now - advanced_)) : newest_s;
}

std::size_t MonitorHistory::first_at(double begin_s) const {
    std::size_t low = 0, high = size_;
    while (low < high) {
        const std::size_t middle = (low + high) / 2;
        if (times_s_[slot(middle)] < begin_s) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

void MonitorHistory::decimate(Quantity quantity, double begin_s, double column_s,
                              std::span<Column> columns) const {
    assert(column_s > 0);
    std::fill(columns.begin(), columns.end(), Column{});
    const auto& ring = values_[static_cast<std::size_t>(quantity)];
    std::size_t before = columns.size();  // column of the sample before; none
    double before_s = 0;
    for (std::size_t i = first_at(begin_s); i < size_; ++i) {
        const double time_s = times_s_[slot(i)], value = ring[slot(i)];
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
