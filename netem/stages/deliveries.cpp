#include "netem/stages/deliveries.hpp"

#include <algorithm>
#include <utility>

namespace thimble {

void Deliveries::configure(std::shared_ptr<const DeliveryTrace> trace, Duration begin) {
    if (trace == trace_) return;
    trace_ = std::move(trace);
    begin_ = begin;
    opportunity_ = 0;
    room_bytes_ = DeliveryTrace::kBytesPerOpportunity;
}

Duration Deliveries::opening(Duration arrival) {
    if (room_bytes_ == 0) {
        ++opportunity_;
        room_bytes_ = DeliveryTrace::kBytesPerOpportunity;
    }
    const std::uint64_t first = trace_->first_after(std::max(arrival, begin_));
    if (first > opportunity_) {
        opportunity_ = first;
        room_bytes_ = DeliveryTrace::kBytesPerOpportunity;
    }
    return trace_->time_of(opportunity_);
}

Duration Deliveries::take(std::size_t bytes) {
    while (bytes > room_bytes_) {
        bytes -= room_bytes_;
        ++opportunity_;
        room_bytes_ = DeliveryTrace::kBytesPerOpportunity;
    }
    room_bytes_ -= bytes;
    return trace_->time_of(opportunity_);
}

}  // namespace thimble
