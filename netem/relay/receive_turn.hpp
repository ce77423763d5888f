// How many datagrams to ask a socket for. To look in vain for one more costs the kernel a good part of what a datagram costs, so
// a socket that is asked whenever it has something is asked for one, and for more when there are. Pure arithmetic.
#pragma once

#include <algorithm>
#include <cstddef>

#include "netem/relay/datagram_batch.hpp"

namespace thimble {

class ReceiveTurn {
  public:
    std::size_t most() const { return most_; }
    // The result. Less than half: half as many the next time. All, so often in a row: twice as many.
    void got(std::size_t count) {
        full_ = count == most_ ? full_ + 1 : 0;
        if (full_ == kOften) {
            most_ = std::min(2 * most_, ReceiveBatch::kSize);
            full_ = 0;
        } else if (2 * count <= most_) {
            most_ = std::max<std::size_t>(1, most_ / 2);
        }
    }

  private:
    static constexpr unsigned kOften = 8;
    std::size_t most_ = 1;
    unsigned full_ = 0;
};

}  // namespace thimble
