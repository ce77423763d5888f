#include "netem/delivery_trace.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace thimble {

using std::chrono::milliseconds;

DeliveryTrace::DeliveryTrace(std::vector<std::uint32_t> times_ms) : times_ms_(std::move(times_ms)) {
    assert(!times_ms_.empty() && times_ms_.back() > 0);
    assert(std::is_sorted(times_ms_.begin(), times_ms_.end()));
}

Duration DeliveryTrace::time_of(std::uint64_t opportunity) const {
    const auto lap = static_cast<std::int64_t>(opportunity / times_ms_.size());
    return lap * period() + milliseconds{times_ms_[opportunity % times_ms_.size()]};
}

std::uint64_t DeliveryTrace::first_after(Duration time) const {
    if (time < Duration::zero()) return 0;
    // An entry at 0 of the next lap falls together with the last of this one: never look beyond the own lap.
    const std::int64_t lap = time / period();
    const Duration within = time - lap * period();
    const auto after =
        std::upper_bound(times_ms_.begin(), times_ms_.end(), within,
                         [](Duration t, std::uint32_t entry_ms) { return t < milliseconds{entry_ms}; });
    return static_cast<std::uint64_t>(lap) * times_ms_.size() +
           static_cast<std::uint64_t>(after - times_ms_.begin());
}

double DeliveryTrace::mean_bits_per_s() const {
    return static_cast<double>(times_ms_.size() * kBytesPerOpportunity * 8) / to_seconds(period());
}

}  // namespace thimble
