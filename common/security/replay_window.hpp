// Which counters have been accepted: each at most once, none that is too old to know. The ring of RFC 6479.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace thimble {

class ReplayWindow {
  public:
    // So far behind the newest a counter may come and still be judged.
    static constexpr std::uint64_t kReach = 1984;

    // Counters begin with 1.
    bool is_fresh(std::uint64_t counter) const {
        if (counter == 0) return false;
        if (counter > newest_) return true;
        if (newest_ - counter >= kReach) return false;
        return (words_[word(counter)] >> (counter % kWordBits) & 1U) == 0;
    }
    // Of one that is fresh and proven: a forged counter must not move the window.
    void accept(std::uint64_t counter) {
        if (counter > newest_) {
            const std::uint64_t before = newest_ / kWordBits;
            const std::uint64_t cleared = std::min(counter / kWordBits - before, kWords);
            for (std::uint64_t i = 1; i <= cleared; ++i) words_[(before + i) % kWords] = 0;
            newest_ = counter;
        }
        words_[word(counter)] |= std::uint64_t{1} << (counter % kWordBits);
    }

  private:
    static constexpr std::uint64_t kWordBits = 64, kWords = 32;
    static_assert(kReach == (kWords - 1) * kWordBits);
    static std::size_t word(std::uint64_t counter) { return counter / kWordBits % kWords; }

    std::uint64_t newest_ = 0;
    std::array<std::uint64_t, kWords> words_{};
};

}  // namespace thimble
