// Records compared bit by bit.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include "session/records/trial_record.hpp"

namespace thimble::test {

// FNV-1a over every field of every sample.
class TrajectoryHash {
  public:
    explicit TrajectoryHash(const TrialRecord& record) {
        for (const TrajectorySample& s : record.samples) add(s);
    }
    std::uint64_t value() const { return value_; }

  private:
    void add(const TrajectorySample& s) {
        for (const double number : {s.time_s, s.position_needle_m, s.position_surface_m, s.force_tissue_N,
                                    s.force_fixture_N, s.force_total_N, s.contact_time_s}) {
            add(std::bit_cast<std::uint64_t>(number));
        }
        add((static_cast<std::uint64_t>(s.phase) << 1) | (s.fixture_present ? 1U : 0U));
    }
    void add(std::uint64_t word) {
        for (int shift = 0; shift < 64; shift += 8)
            value_ = (value_ ^ ((word >> shift) & 0xff)) * 0x100000001b3U;
    }

    std::uint64_t value_ = 0xcbf29ce484222325U;
};

inline bool same_sample(const TrajectorySample& a, const TrajectorySample& b) {
    const auto same = [](double x, double y) {
        return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
    };
    return same(a.time_s, b.time_s) && same(a.position_needle_m, b.position_needle_m) &&
           same(a.position_surface_m, b.position_surface_m) && same(a.force_tissue_N, b.force_tissue_N) &&
           same(a.force_fixture_N, b.force_fixture_N) && same(a.force_total_N, b.force_total_N) &&
           same(a.contact_time_s, b.contact_time_s) && a.phase == b.phase &&
           a.fixture_present == b.fixture_present;
}

inline bool same_samples(const TrialRecord& a, const TrialRecord& b) {
    return std::equal(a.samples.begin(), a.samples.end(), b.samples.begin(), b.samples.end(), same_sample);
}

// Samples from the start that agree.
inline std::size_t common_samples(const TrialRecord& a, const TrialRecord& b) {
    const auto end =
        std::mismatch(a.samples.begin(), a.samples.end(), b.samples.begin(), b.samples.end(), same_sample);
    return static_cast<std::size_t>(end.first - a.samples.begin());
}

}  // namespace thimble::test
