// A relay's totals so far, by direction: counts, achieved delays, due-time errors. Data and arithmetic, no clock.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "common/histogram.hpp"
#include "common/runtime/event_waiter.hpp"
#include "netem/link_model.hpp"
#include "netem/relay/packet_record.hpp"
#include "netem/relay/relay_settings.hpp"

namespace thimble {

// A packet that leaves later than this after its due time met a stall of the machine.
inline constexpr Duration kStall = std::chrono::milliseconds{1};

// Mean and standard deviation without keeping the samples (Welford, Technometrics 4, 1962).
class DelayMoments {
  public:
    void add(Duration sample) {
        const double value_s = to_seconds(sample), offset_s = value_s - mean_s_;
        mean_s_ += offset_s / static_cast<double>(++count_);
        squares_s2_ += offset_s * (value_s - mean_s_);
    }
    double mean_s() const { return mean_s_; }
    double deviation_s() const {
        return count_ < 2 ? 0 : std::sqrt(squares_s2_ / static_cast<double>(count_ - 1));
    }
    double sum_s() const { return mean_s_ * static_cast<double>(count_); }

  private:
    double mean_s_ = 0, squares_s2_ = 0;
    std::uint64_t count_ = 0;
};

struct DirectionTotals {
    LinkCounters packets;       // of all flows
    std::uint64_t bytes = 0;    // sent
    std::uint64_t refused = 0;  // delivered by the link, not taken by the kernel
    std::uint64_t late = 0;     // sent more than kStall after they were due
    Histogram delay;            // sent minus received
    Histogram error;            // sent minus due, never below zero: nothing leaves early
    DelayMoments delay_moments, error_moments;
    std::uint64_t in_flight = 0;  // now, of all flows

    // A packet that left its link: `accepted` says whether the kernel took it.
    void note(const Departure& departure, SessionTime sent, bool accepted) {
        if (!accepted) {
            ++refused;
            return;
        }
        bytes += departure.bytes.size();
        delay.add(sent - departure.received);
        delay_moments.add(sent - departure.received);
        error.add(sent - departure.due);
        error_moments.add(sent - departure.due);
        if (sent - departure.due > kStall) ++late;
    }
};

struct RelayTotals {
    std::array<DirectionTotals, 2> direction;  // RelayDirection
    std::uint64_t flows = 0, flows_opened = 0, flows_refused = 0,
                  flows_failed = 0;  // packets: beyond the limit; without a socket
    std::uint64_t stalls = 0;        // wake-ups more than kStall after the due time they were for
    std::uint64_t clock_steps = 0, untrusted_stamps = 0;
    std::uint64_t dropped_by_kernel = 0;  // before this program could read them
    std::uint64_t log_missing = 0;
    std::vector<std::uint64_t>
        closed_ports{};  // by inlet: answers of its server's machine that the port is closed
    Duration running{};

    const DirectionTotals& operator[](RelayDirection d) const {
        return direction[static_cast<std::size_t>(d)];
    }
};

struct RelayState {
    LinkPair links;
    RelayTotals totals;
    WaitCounters waiting;
    Duration margin{};
    bool precise = false;
    Duration send_lead{};     // RelayEngine::send_lead
    std::string log_fault{};  // empty: the packet log has all
};

}  // namespace thimble
