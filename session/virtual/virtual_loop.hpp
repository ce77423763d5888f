// Drives processes in virtual time: a clock that jumps from event to event, no thread, no sleep, no
// randomness of its own. The same processes and the same seed give the same bits on every machine.
#pragma once

#include <cstdint>
#include <vector>

#include "common/process.hpp"

namespace thimble {

class VirtualLoop {
  public:
    // At most 32. At one instant, processes run in the order they were added.
    // Returns the bit that a channel must set in *wake_mask() to wake this process.
    std::uint32_t add(Process& process);
    std::uint32_t* wake_mask() { return &woken_; }

    SessionTime now() const { return now_; }
    // Makes a process due now, whatever it said before (something outside the loop changed its mind).
    void poke(std::uint32_t bit) { woken_ |= bit; }

    // A process that is not called any more, whatever is due or waits for it, until it is thawed: then at once.
    void freeze(std::uint32_t bit) { frozen_ |= bit; }
    void thaw(std::uint32_t bit);
    // Another process takes the place of this one, and is due now.
    void replace(std::uint32_t bit, Process& process);

    // One instant: everything due at the earliest wake-up, and all that this sets off without delay. False if
    // nothing will ever happen again.
    bool step();
    std::uint64_t ticks() const { return ticks_; }

  private:
    struct Entry {
        Process* process = nullptr;
        SessionTime next = kNever;
    };
    void run_instant(std::uint32_t due);

    std::vector<Entry> entries_;
    std::uint32_t woken_ = 0, frozen_ = 0;
    SessionTime now_{};
    std::uint64_t ticks_ = 0;
    int instants_at_now_ = 0;
};

}  // namespace thimble
