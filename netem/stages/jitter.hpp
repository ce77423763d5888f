// How far the delay of packet n is from the mean, in units of the spread.
//
// Without correlation each deviate is a quantile of one number of its own packet. With correlation r the numbers are
// an AR(1) Gaussian over packet numbers, z(n) = r z(n-1) + sqrt(1 - r^2) e(n), and the deviate is the quantile at
// z(n): the marginal is the shape itself, which netem's own correlation narrows (Jurgelionis et al. 2011, "An
// Empirical Study of NetEm Network Emulation Functionalities"). Neighbours of a normal shape then correlate by r, of
// a uniform one by (6 / pi) asin(r / 2), of others by a little less than r.
#pragma once

#include <cassert>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>

#include "common/random.hpp"
#include "netem/stages/delay_shape.hpp"

namespace thimble {

class Jitter {
  public:
    explicit Jitter(const StreamKey& key) : stream_(key) {}

    void configure(std::shared_ptr<const DelayShape> shape, double correlation) {
        assert(shape != nullptr && correlation >= 0 && correlation < 1);
        shape_ = std::move(shape);
        correlation_ = correlation;
        innovation_ = std::sqrt(1 - correlation * correlation);
    }
    // Then each packet has to ask, also one that is lost: the chain moves once per packet.
    bool correlated() const { return correlation_ > 0; }
    double deviate(std::uint64_t packet) {
        stream_.seek(kNumbersPerDeviate * packet);
        if (correlated()) return shape_->at_normal(chain(packet));
        return shape_->takes_normal() ? shape_->at_normal(stream_.normal())
                                      : shape_->at_uniform(stream_.uniform());
    }

  private:
    // A normal number takes one of the stream, rarely a few more (rejection): room enough that no packet uses its
    // neighbour's.
    static constexpr std::uint64_t kNumbersPerDeviate = 16;

    // The first packet, or the first after a time without correlation, finds the chain in its stationary distribution.
    double chain(std::uint64_t packet) {
        const double fresh = stream_.normal();
        const bool follows = packet > 0 && packet == next_;
        z_ = follows ? correlation_ * z_ + innovation_ * fresh : fresh;
        next_ = packet + 1;
        return z_;
    }

    RandomStream stream_;
    std::shared_ptr<const DelayShape> shape_;
    double correlation_ = 0;
    double innovation_ = 1;
    double z_ = 0;
    std::uint64_t next_ = 0;  // packet up to which the chain has been followed; 0: not begun
};

}  // namespace thimble
