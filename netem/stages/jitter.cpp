#include "netem/stages/jitter.hpp"

#include <cassert>
#include <cmath>
#include <utility>

namespace thimble {
namespace {

// A normal number takes one of the stream, rarely a few more (rejection): room enough that no packet uses its
// neighbour's.
constexpr std::uint64_t kNumbersPerDeviate = 16;

}  // namespace

void Jitter::configure(std::shared_ptr<const DelayShape> shape, double correlation) {
    assert(shape != nullptr && correlation >= 0 && correlation < 1);
    shape_ = std::move(shape);
    correlation_ = correlation;
    innovation_ = std::sqrt(1 - correlation * correlation);
}

double Jitter::deviate(std::uint64_t packet) {
    stream_.seek(kNumbersPerDeviate * packet);
    if (correlated()) return shape_->at_normal(chain(packet));
    return shape_->takes_normal() ? shape_->at_normal(stream_.normal())
                                  : shape_->at_uniform(stream_.uniform());
}

// The first packet, or the first after a time without correlation, finds the chain in its stationary distribution.
double Jitter::chain(std::uint64_t packet) {
    const double fresh = stream_.normal();
    const bool follows = packet > 0 && packet == next_;
    z_ = follows ? correlation_ * z_ + innovation_ * fresh : fresh;
    next_ = packet + 1;
    return z_;
}

}  // namespace thimble
