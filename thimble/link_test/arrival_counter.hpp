// Counts the arrivals of a numbered sequence: distinct numbers, duplicates, and numbers that came after a later one.
#pragma once

#include <bitset>
#include <cstdint>

#include "common/flow.hpp"

namespace thimble {

class ArrivalCounter {
  public:
    // True for a number that is new. A number more than kWindow behind the newest counts as a duplicate, because its fate is unknown.
    bool add(std::uint32_t sequence) {
        const std::int32_t ahead = any_ ? sequence_ahead(sequence, newest_) : 1;
        if (ahead > 0) {
            forget(any_ ? static_cast<std::uint32_t>(ahead) : kWindow);
            newest_ = sequence;
            any_ = true;
        } else if (ahead <= -static_cast<std::int32_t>(kWindow) || seen_[sequence % kWindow]) {
            ++duplicates_;
            return false;
        } else {
            ++reordered_;
        }
        seen_[sequence % kWindow] = true;
        ++distinct_;
        return true;
    }

    std::uint32_t distinct() const { return distinct_; }
    std::uint32_t duplicates() const { return duplicates_; }
    std::uint32_t reordered() const { return reordered_; }

  private:
    static constexpr std::uint32_t kWindow = 1024;  // a power of two: numbers wrap

    void forget(std::uint32_t steps) {
        if (steps >= kWindow) {
            seen_.reset();
        } else {
            for (std::uint32_t i = 1; i <= steps; ++i) seen_[(newest_ + i) % kWindow] = false;
        }
    }

    std::bitset<kWindow> seen_;
    bool any_ = false;
    std::uint32_t newest_ = 0;
    std::uint32_t distinct_ = 0, duplicates_ = 0, reordered_ = 0;
};

}  // namespace thimble
