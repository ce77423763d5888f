// How far the delay of packet n is from the mean, in units of the spread.
//
// Without correlation each deviate is a quantile of one number of its own packet. With correlation r the numbers are
// an AR(1) Gaussian over packet numbers, z(n) = r z(n-1) + sqrt(1 - r^2) e(n), and the deviate is the quantile at
// z(n): the marginal is the shape itself, which netem's own correlation narrows (Jurgelionis et al. 2011, "An
// Empirical Study of NetEm Network Emulation Functionalities"). Neighbours of a normal shape then correlate by r, of
// a uniform one by (6 / pi) asin(r / 2), of others by a little less than r.
#pragma once

#include <cstdint>
#include <memory>

#include "common/random.hpp"
#include "netem/stages/delay_shape.hpp"

namespace thimble {

class Jitter {
  public:
    explicit Jitter(const StreamKey& key) : stream_(key) {}

    void configure(std::shared_ptr<const DelayShape> shape, double correlation);
    // Then each packet has to ask, also one that is lost: the chain moves once per packet.
    bool correlated() const { return correlation_ > 0; }
    double deviate(std::uint64_t packet);

  private:
    double chain(std::uint64_t packet);

    RandomStream stream_;
    std::shared_ptr<const DelayShape> shape_;
    double correlation_ = 0;
    double innovation_ = 1;
    double z_ = 0;
    std::uint64_t next_ = 0;  // packet up to which the chain has been followed; 0: not begun
};

}  // namespace thimble
