// A link that sends when its trace says so, as mahimahi's: each opportunity moves 1500 bytes of what waits; a packet
// that does not fit goes on with the next, and unused room is lost. A packet that comes in the very
// instant of an opportunity is too late for it.
#pragma once

#include <algorithm>
#include <memory>
#include <utility>

#include "netem/delivery_trace.hpp"

namespace thimble {

class Deliveries {
  public:
    // Times count from the start of the trial. Another trace gives its first opportunity after `begin`.
    void configure(std::shared_ptr<const DeliveryTrace> trace, Duration begin = {}) {
        if (trace == trace_) return;
        trace_ = std::move(trace);
        begin_ = begin;
        go_to(0);
    }
    bool active() const { return trace_ != nullptr; }

    // When a packet that came at `arrival` begins to go. Never goes back; asking twice changes nothing.
    Duration opening(Duration arrival) {
        if (room_bytes_ == 0) go_to(opportunity_ + 1);
        const std::uint64_t first = trace_->first_after(std::max(arrival, begin_));
        if (first > opportunity_) go_to(first);
        return trace_->time_of(opportunity_);
    }
    // It goes then: when its last byte is through.
    Duration take(std::size_t bytes) {
        while (bytes > room_bytes_) {
            bytes -= room_bytes_;
            go_to(opportunity_ + 1);
        }
        room_bytes_ -= bytes;
        return trace_->time_of(opportunity_);
    }

  private:
    void go_to(std::uint64_t opportunity) {
        opportunity_ = opportunity;
        room_bytes_ = DeliveryTrace::kBytesPerOpportunity;
    }

    std::shared_ptr<const DeliveryTrace> trace_;
    std::uint64_t opportunity_ = 0;
    std::size_t room_bytes_ = 0;
    Duration begin_{};
};

}  // namespace thimble
