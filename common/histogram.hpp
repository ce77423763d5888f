// Durations in logarithmic buckets: quantiles of a million samples in fixed memory, no allocation per sample.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>
#include <vector>

#include "common/time.hpp"

namespace thimble {

class Histogram {
  public:
    Histogram() : buckets_((kOctaves + 1) * kPerOctave, 0) {}

    // Negative durations count as zero.
    void add(Duration duration) {
        const auto ns = static_cast<std::uint64_t>(std::max<Duration::rep>(duration.count(), 0));
        ++buckets_[index(ns)];
        min_ = count_ == 0 ? ns : std::min(min_, ns);
        max_ = std::max(max_, ns);
        ++count_;
    }
    void merge(const Histogram& other) {
        if (other.count_ == 0) return;
        for (std::size_t i = 0; i < buckets_.size(); ++i) buckets_[i] += other.buckets_[i];
        min_ = count_ == 0 ? other.min_ : std::min(min_, other.min_);
        max_ = std::max(max_, other.max_);
        count_ += other.count_;
    }
    void clear() {
        std::fill(buckets_.begin(), buckets_.end(), 0U);
        count_ = 0;
        min_ = max_ = 0;
    }
    std::uint64_t count() const { return count_; }
    Duration worst() const { return Duration{static_cast<Duration::rep>(max_)}; }
    Duration best() const { return Duration{static_cast<Duration::rep>(min_)}; }

    // How many are no longer than this, to 0.4 %.
    std::uint64_t count_up_to(Duration longest) const {
        const std::size_t end =
            index(static_cast<std::uint64_t>(std::max<Duration::rep>(longest.count(), 0)));
        return std::accumulate(buckets_.begin(), buckets_.begin() + static_cast<std::ptrdiff_t>(end) + 1,
                               std::uint64_t{0});
    }

    // The sample at fraction q of the sorted samples, to 0.4 %; zero without samples.
    Duration quantile(double q) const {
        if (count_ == 0) return {};
        const auto rank = static_cast<std::uint64_t>(q * static_cast<double>(count_ - 1));
        std::uint64_t seen = 0;
        for (std::size_t i = 0; i < buckets_.size(); ++i) {
            seen += buckets_[i];
            if (seen > rank) return Duration{static_cast<Duration::rep>(std::clamp(middle(i), min_, max_))};
        }
        return worst();
    }

  private:
    static constexpr unsigned kBits = 7;  // 128 buckets per octave
    static constexpr std::size_t kPerOctave = std::size_t{1} << kBits;
    static constexpr std::size_t kOctaves = 34;  // up to 2^41 ns, about half an hour

    static std::size_t index(std::uint64_t ns) {
        if (ns < kPerOctave) return ns;
        const auto shift = static_cast<unsigned>(std::bit_width(ns)) - kBits - 1;
        if (shift >= kOctaves) return (kOctaves + 1) * kPerOctave - 1;
        return (shift + 1) * kPerOctave + ((ns >> shift) - kPerOctave);
    }
    static std::uint64_t middle(std::size_t i) {
        if (i < kPerOctave) return i;
        const std::size_t shift = i / kPerOctave - 1;
        const std::uint64_t low = (kPerOctave + i % kPerOctave) << shift;
        return low + ((std::uint64_t{1} << shift) >> 1);
    }

    std::vector<std::uint32_t> buckets_;
    std::uint64_t count_ = 0, min_ = 0, max_ = 0;
};

}  // namespace thimble
