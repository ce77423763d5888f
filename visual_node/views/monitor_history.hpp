// The last seconds of Monitor messages, as curves: a ring of samples, filled at up to 250 Hz, read at each frame. Memory is taken once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <boost/circular_buffer.hpp>

#include "common/messages.hpp"
#include "common/time.hpp"

namespace thimble {

// The values of the curves, in the units of Monitor. A positive force pushes the hand out. A one-way delay has two curves, the
// edges of its bound.
enum class Quantity : std::uint8_t {
    kNeedle_m,
    kSurface_m,
    kFixture_m,
    kForceTotal_N,
    kForceHand_N,
    kRoundTrip_s,
    kOneWay_s,
    kOneWayLow_s,
    kOneWayHigh_s,
    kEnergy_J,
    kCount,
};
inline constexpr std::size_t kQuantityCount = static_cast<std::size_t>(Quantity::kCount);

// One pixel column of a curve.
struct Column {
    double low = 0, high = 0;  // of all samples in it
    double last = 0;           // the newest of them
    bool present = false;      // false: no sample, and none to draw a line between
    bool joined = false;       // goes on from the column before; false: a gap, or the curve's begin
};

// Samples further apart are not joined by a line: twelve of the 4 ms between two Monitors.
inline constexpr double kMonitorGap_s = 0.05;

class MonitorHistory {
  public:
    // Holds `window_s` of samples at 250 Hz, and a second more.
    explicit MonitorHistory(double window_s = 10);

    // A new trial, or a time that goes back (a replay's seek), starts anew. The same time again adds nothing, and
    // neither does a message whose trial has not begun. `replay`: of a recorded trial, whose time may be slow or stand still.
    void add(SessionTime now, std::uint32_t trial, const Monitor& monitor, bool replay = false);
    void clear() { samples_.clear(); }

    // Right edge of a plot, s since the trial's start. It moves on while the trial runs, so that silence shows as a
    // growing gap. In a replay that stands still it stands as well.
    double end_s(SessionTime now) const;
    double window_s() const { return window_s_; }
    std::size_t size() const { return samples_.size(); }
    std::uint32_t trial() const { return trial_; }

    // Smallest and largest sample of each of `columns`, which divide [begin_s, begin_s + columns x column_s), so that no
    // oscillation is hidden however coarse the columns are. Where columns are finer than samples, a line joins them.
    // Not-known values (fixture absent, delay not measured) are gaps. begin_s should be a multiple of column_s
    // (column_begin), or the curve trembles as it moves.
    void decimate(Quantity quantity, double begin_s, double column_s, std::span<Column> columns) const;

  private:
    struct Sample {
        double time_s = 0;
        std::array<double, kQuantityCount> values{};  // NaN: not known
    };

    double window_s_;
    boost::circular_buffer<Sample> samples_;
    std::uint32_t trial_ = 0;
    bool running_ = false;
    double newest_s_ = 0;     // time of the newest message, whether it became a sample or not
    SessionTime advanced_{};  // when that came
};

// Begin of the newest `columns` columns that hold end_s in their last one: a multiple of column_s.
double column_begin(double end_s, double column_s, std::size_t columns);

}  // namespace thimble
