#include "master/operator/noise.hpp"

#include <cassert>
#include <cmath>
#include <numbers>

namespace thimble {

OrnsteinUhlenbeck::OrnsteinUhlenbeck(const StreamKey& key, double correlation_s, Duration tick)
    : random_(key),
      keep_(std::exp(-to_seconds(tick) / correlation_s)),
      add_(std::sqrt(1 - keep_ * keep_)),
      value_(random_.normal()) {
    assert(correlation_s > 0);
}

Tremor::Tremor(const StreamKey& key, double frequency_Hz, double damping_ratio, Duration tick)
    : random_(key) {
    assert(damping_ratio > 0 && damping_ratio < 1);
    const double angle = 2 * std::numbers::pi * frequency_Hz * to_seconds(tick);
    const double radius = std::exp(-damping_ratio * angle);
    recent_ = 2 * radius * std::cos(angle * std::sqrt(1 - damping_ratio * damping_ratio));
    older_ = -radius * radius;
    // Yule-Walker: correlation between neighbours, then the innovation that leaves unit variance.
    const double neighbours = recent_ / (1 - older_);
    add_ = std::sqrt(1 - recent_ * neighbours - older_ * (recent_ * neighbours + older_));
    before_ = random_.normal();
    value_ = neighbours * before_ + std::sqrt(1 - neighbours * neighbours) * random_.normal();
}

}  // namespace thimble
