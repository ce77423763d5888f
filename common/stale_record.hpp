// When a node's stale policy (stale_policy.hpp) acted: in which trials, how often, how long. For its report.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/time.hpp"

namespace thimble {

class StaleRecord {
  public:
    struct Trial {
        std::uint32_t trial = 0;  // its number on the wire
        unsigned times = 0;
        Duration acted{}, longest{};
    };

    // At each tick of a running trial: whether the policy acts now. It counts from the
    // trial's first call with false: slave_sim makes that one at the first command, master and fingers in the first tick.
    void watch(SessionTime now, std::uint32_t trial, bool acts) {
        if (trial != trial_) {
            end(now);
            trial_ = trial;
            heard_ = false;
        }
        heard_ = heard_ || !acts;
        if (!heard_) return;
        if (acts && !acting_) begin(now);
        if (!acts) end(now);
    }
    // The trial is over, or the input is back.
    void end(SessionTime now) {
        if (!acting_) return;
        acting_ = false;
        Trial& last = trials_[(count_ - 1) % trials_.size()];
        last.acted += now - since_;
        last.longest = std::max(last.longest, now - since_);
    }

    // Trials in which it acted since the start of the program. Only the newest kKept of them are known one by one, in no order.
    std::size_t trials() const { return count_; }
    std::span<const Trial> known() const {
        return std::span(trials_).first(std::min(count_, trials_.size()));
    }

  private:
    static constexpr std::size_t kKept = 64;

    void begin(SessionTime now) {
        acting_ = true;
        since_ = now;
        if (count_ == 0 || trials_[(count_ - 1) % trials_.size()].trial != trial_)
            trials_[count_++ % trials_.size()] = {trial_, 0, {}, {}};
        ++trials_[(count_ - 1) % trials_.size()].times;
    }

    std::array<Trial, kKept> trials_{};
    std::size_t count_ = 0;
    std::uint32_t trial_ = 0;
    bool heard_ = false, acting_ = false;
    SessionTime since_{};
};

}  // namespace thimble
