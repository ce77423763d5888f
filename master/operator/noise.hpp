// Random processes of the virtual operator, one number per tick, exact in distribution at the ticks whatever
// their length. Each owns its stream, so switching one off changes no other.
#pragma once

#include <cassert>
#include <cmath>
#include <numbers>

#include "common/math/portable.hpp"
#include "common/random.hpp"
#include "common/time.hpp"

namespace thimble {

// The next draw of a stream. It may be made before it is needed, while the processor waits for the limb's divisions.
class PreparedNormal {
  public:
    void prepare(RandomStream& random) {
        if (!ready_) value_ = random.normal();
        ready_ = true;
    }
    double take(RandomStream& random) {
        prepare(random);
        ready_ = false;
        return value_;
    }

  private:
    double value_ = 0;
    bool ready_ = false;
};

// Ornstein-Uhlenbeck process of unit variance and correlation exp(-t / tau):
//     n(t + dt) = a n(t) + sqrt(1 - a^2) xi,  a = exp(-dt / tau). Starts in its stationary distribution.
class OrnsteinUhlenbeck {
  public:
    OrnsteinUhlenbeck(const StreamKey& key, double correlation_s, Duration tick)
        : random_(key),
          keep_(portable::exp(-to_seconds(tick) / correlation_s)),
          add_(std::sqrt(1 - keep_ * keep_)),
          value_(random_.normal()) {
        assert(correlation_s > 0);
    }
    double next() {
        value_ = keep_ * value_ + add_ * fresh_.take(random_);
        return value_;
    }
    double value() const { return value_; }
    void prepare() { fresh_.prepare(random_); }

  private:
    RandomStream random_;
    PreparedNormal fresh_;
    double keep_, add_, value_;
};

// A resonator driven by white noise, sampled: the AR(2) process whose poles are exp((-zeta w +- i w_d) dt),
// scaled to unit variance (Yule-Walker). Starts in its stationary distribution.
class Tremor {
  public:
    Tremor(const StreamKey& key, double frequency_Hz, double damping_ratio, Duration tick) : random_(key) {
        assert(damping_ratio > 0 && damping_ratio < 1);
        const double angle = 2 * std::numbers::pi * frequency_Hz * to_seconds(tick);
        const double radius = portable::exp(-damping_ratio * angle);
        recent_ = 2 * radius * portable::cos(angle * std::sqrt(1 - damping_ratio * damping_ratio));
        older_ = -radius * radius;
        // Yule-Walker: correlation between neighbours, then the innovation that leaves unit variance.
        const double neighbours = recent_ / (1 - older_);
        add_ = std::sqrt(1 - recent_ * neighbours - older_ * (recent_ * neighbours + older_));
        before_ = random_.normal();
        value_ = neighbours * before_ + std::sqrt(1 - neighbours * neighbours) * random_.normal();
    }
    double next() {
        const double fresh = recent_ * value_ + older_ * before_ + add_ * fresh_.take(random_);
        before_ = value_;
        value_ = fresh;
        return fresh;
    }
    void prepare() { fresh_.prepare(random_); }

  private:
    RandomStream random_;
    PreparedNormal fresh_;
    double recent_, older_, add_, value_, before_;
};

}  // namespace thimble
