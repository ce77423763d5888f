// One node's clock, computed from all exchanges of a session.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "common/csv/csv_file.hpp"
#include "common/messages.hpp"
#include "session/clocks/clock_prober.hpp"

namespace thimble {

inline constexpr std::array kClockedNodes{Role::kMaster, Role::kSlaveSim, Role::kCutaneous, Role::kVisual,
                                          Role::kNetem};

// Every exchange of stamps of a session, raw, as CSV: nodes/clocks_<delay>ms.csv of a run. Every figure about clocks is computed
// from this file, so a reader can compute it again.
struct ClockRecord {
    Role node = Role::kMaster;  // whose clock is the far one; the near one is the session's
    ClockExchange exchange;
};

class ClockWriter {
  public:
    // Replaces an earlier file. Throws Error (usage) if it cannot be created.
    explicit ClockWriter(const std::filesystem::path& path);
    void append(Role node, const ClockExchange& exchange);
    void flush() { file_.flush(); }

  private:
    CsvFile file_;
};

// Throws Error (data) naming line and column of what cannot be read.
std::vector<ClockRecord> read_clock_file(const std::filesystem::path& path);

// A one-way delay: surely within value +- bound.
struct OneWayDelay {
    double median_s = 0;
    double bound_s = 0;
    bool known() const { return bound_s < median_s; }
};

struct ClockSummary {
    std::uint64_t exchanges = 0;
    std::uint64_t steps = 0;                 // what follows is of the exchanges since the last one
    std::optional<OffsetInterval> offset;    // at the last exchange; none without exchanges
    bool even = false;                       // a straight line passes through all bounds
    double rate_low = 0, rate_high = 0;      // seconds per second; if even
    std::optional<OneWayDelay> there, back;  // if even
    double round_trip_median_s = 0;

    bool rate_known() const;  // narrower than what any two clocks may do
};

// In the order in which they were answered.
ClockSummary summarize_clock(std::span<const ClockExchange> exchanges);

struct NodeClock {
    double delay_s = 0;  // of the condition
    Role node = Role::kMaster;
    ClockSummary summary;
};

// A summary per node that has exchanges, in the order of their roles.
std::vector<NodeClock> clocks_of(double delay_s, const std::vector<ClockRecord>& records);

}  // namespace thimble
