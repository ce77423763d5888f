// When a link could send, as mahimahi records it (Netravali et al., "Mahimahi: accurate record-and-replay for
// HTTP", USENIX ATC 2015): each entry is an opportunity to deliver 1500 bytes in that millisecond. Read by
// formats/trace_files.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/time.hpp"

namespace thimble {

class DeliveryTrace {
  public:
    static constexpr std::size_t kBytesPerOpportunity = 1500;

    // Milliseconds since the start, not falling, the last above 0: with it the trace begins again.
    explicit DeliveryTrace(std::vector<std::uint32_t> times_ms);

    // Since the start of the trial, of opportunity 0, 1, ...; endless, since the trace wraps.
    Duration time_of(std::uint64_t opportunity) const;
    // The first opportunity after `time` (not at it).
    std::uint64_t first_after(Duration time) const;

    Duration period() const { return std::chrono::milliseconds{times_ms_.back()}; }
    // Over a whole period.
    double mean_bits_per_s() const;
    const std::vector<std::uint32_t>& times_ms() const { return times_ms_; }

  private:
    std::vector<std::uint32_t> times_ms_;
};

}  // namespace thimble
