// Delay, loss and rate as they were measured or designed: by packet number or by time (read by
// trace_files.hpp).
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "common/time.hpp"

namespace thimble {

enum class TraceBy : std::uint8_t { kPacket, kTime };
enum class TraceBetween : std::uint8_t {
    kHold,
    kLinear
};                                                    // between two rows: the earlier, or a straight line
enum class TraceEnd : std::uint8_t { kWrap, kHold };  // after the last row: again from the first, or the last

// The values from this row on. A column that the trace does not have is left at its default.
struct TraceRow {
    std::int64_t at = 0;  // packet number, or nanoseconds since the start of the trial
    Duration delay{};
    double loss = 0;        // probability; 0 and 1 replay a recorded loss
    double bits_per_s = 0;  // above 0 where there is such a column

    bool operator==(const TraceRow&) const = default;
};

struct TraceLayout {
    TraceBy by = TraceBy::kTime;
    TraceBetween between = TraceBetween::kHold;
    TraceEnd end = TraceEnd::kWrap;
    bool has_delay = true, has_loss = false, has_rate = false;

    bool operator==(const TraceLayout&) const = default;
};

class PacketTrace {
  public:
    // At least one row, `at` from 0 or later and rising strictly; delays not negative, losses in [0, 1], rates
    // above 0 if there are any.
    PacketTrace(std::vector<TraceRow> rows, const TraceLayout& layout);

    // The row at `position` (same unit as TraceRow::at, not negative); the first row before the first position.
    TraceRow at(std::int64_t position) const;
    // The row for this packet. `time`: its arrival since the start of the trial.
    TraceRow of(std::uint64_t packet, Duration time) const {
        return at(layout_.by == TraceBy::kPacket ? static_cast<std::int64_t>(packet)
                                                 : std::max<std::int64_t>(0, time.count()));
    }
    // After which a trace that wraps begins again: the last row lasts as long as the one before it (a single row:
    // one packet, one second).
    std::int64_t period() const { return period_; }
    // Over one period, each row until the next.
    double mean_delay_ns() const { return mean_delay_ns_; }
    double mean_loss() const { return mean_loss_; }

    const std::vector<TraceRow>& rows() const { return rows_; }
    const TraceLayout& layout() const { return layout_; }

  private:
    std::vector<TraceRow> rows_;
    TraceLayout layout_;
    std::int64_t period_;
    double mean_delay_ns_, mean_loss_;  // made once: a trace may have millions of rows
};

}  // namespace thimble
