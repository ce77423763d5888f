#include "common/runtime/wait_margin.hpp"

#include <algorithm>

namespace thimble {
namespace {

constexpr unsigned kLeftOut = 2;  // the worst of the list
constexpr unsigned kLeast_us = 2;
constexpr std::int64_t kAllowed_ns = 80'000'000;

}  // namespace

void WaitMargin::add(Duration lateness) {
    const std::int64_t us = std::max<std::int64_t>(0, (lateness.count() + 999) / 1000);
    if (us >= kLimit_us) return;
    if (filled_ == kSamples) {
        --count_[recent_us_[next_]];
    } else {
        ++filled_;
    }
    recent_us_[next_] = static_cast<std::uint8_t>(us);
    ++count_[static_cast<std::size_t>(us)];
    next_ = (next_ + 1) % kSamples;
    if (next_ % kRefresh == 0) refresh();
}

void WaitMargin::refresh() {
    unsigned above = 0;
    unsigned us = kLimit_us;
    while (us > 0 && above + count_[us - 1] <= kLeftOut) above += count_[--us];
    margin_us_ = std::max(us > 0 ? us - 1 : 0, kLeast_us);
}

void SpinBudget::advance(SessionTime now) {
    const std::int64_t slice = to_nanoseconds(now) / kSlice_ns;
    const std::int64_t passed = std::min<std::int64_t>(slice - slice_, kSlices);
    for (std::int64_t i = 1; i <= passed; ++i) {
        std::int64_t& oldest = spun_ns_[static_cast<std::size_t>((slice - passed + i) % kSlices)];
        sum_ns_ -= oldest;
        oldest = 0;
    }
    slice_ = std::max(slice_, slice);
}

void SpinBudget::spent(SessionTime until, Duration duration) {
    advance(until);
    spun_ns_[static_cast<std::size_t>(slice_ % kSlices)] += duration.count();
    sum_ns_ += duration.count();
}

Duration SpinBudget::left(SessionTime now) {
    advance(now);
    return Duration{kAllowed_ns - sum_ns_};
}

}  // namespace thimble
