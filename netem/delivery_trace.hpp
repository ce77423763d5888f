// When a link could send, as mahimahi records it (Netravali et al., "Mahimahi: accurate record-and-replay for
// HTTP", USENIX ATC 2015): each entry is an opportunity to deliver 1500 bytes in that millisecond. Read by
// formats/trace_files.hpp.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "common/time.hpp"

namespace thimble {

using std::chrono::milliseconds;

class DeliveryTrace {
  public:
    static constexpr std::size_t kBytesPerOpportunity = 1500;

    // Milliseconds since the start, not falling, the last above 0: with it the trace begins again.
    explicit DeliveryTrace(std::vector<std::uint32_t> times_ms) : times_ms_(std::move(times_ms)) {
        assert(!times_ms_.empty() && times_ms_.back() > 0);
        assert(std::is_sorted(times_ms_.begin(), times_ms_.end()));
    }

    // Since the start of the trial, of opportunity 0, 1, ...; endless, since the trace wraps.
    Duration time_of(std::uint64_t opportunity) const {
        const auto lap = static_cast<std::int64_t>(opportunity / times_ms_.size());
        return lap * period() + milliseconds{times_ms_[opportunity % times_ms_.size()]};
    }

    // The first opportunity after `time` (not at it).
    std::uint64_t first_after(Duration time) const {
        if (time < Duration::zero()) return 0;
        // An entry at 0 of the next lap coincides with the last one of this lap, so only this lap is searched.
        const std::int64_t lap = time / period();
        const Duration within = time - lap * period();
        const auto after =
            std::upper_bound(times_ms_.begin(), times_ms_.end(), within,
                             [](Duration t, std::uint32_t entry_ms) { return t < milliseconds{entry_ms}; });
        return static_cast<std::uint64_t>(lap) * times_ms_.size() +
               static_cast<std::uint64_t>(after - times_ms_.begin());
    }

    Duration period() const { return std::chrono::milliseconds{times_ms_.back()}; }
    const std::vector<std::uint32_t>& times_ms() const { return times_ms_; }

  private:
    std::vector<std::uint32_t> times_ms_;
};

}  // namespace thimble
