// Drives processes in virtual time: a clock that jumps from event to event, no thread, no sleep, no
// randomness of its own. The same processes and the same seed give the same bits on every machine.
#pragma once

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "common/process.hpp"

namespace thimble {

// Messages that chase each other without any delay would hold the clock for ever: a program error.
inline constexpr int kMaxRoundsPerInstant = 10000;

class VirtualLoop {
  public:
    // At most 32. At one instant, processes run in the order they were added.
    // Returns the bit that a channel must set in *wake_mask() to wake this process.
    std::uint32_t add(Process& process) {
        assert(entries_.size() < 32);
        entries_.push_back({&process, process.next_wakeup()});
        return std::uint32_t{1} << (entries_.size() - 1);
    }

    std::uint32_t* wake_mask() { return &woken_; }

    SessionTime now() const { return now_; }
    // Makes a process due now, whatever it said before (something outside the loop changed its mind).
    void poke(std::uint32_t bit) { woken_ |= bit; }

    // A process that is not called any more, whatever is due or waits for it, until it is thawed: then at once.
    void freeze(std::uint32_t bit) {
        frozen_ |= bit;
        entry(bit).next = kNever;
    }
    void thaw(std::uint32_t bit) {
        if ((frozen_ & bit) != 0) woken_ |= bit;
        frozen_ &= ~bit;
    }

    // Another process takes the place of this one, and is due now.
    void replace(std::uint32_t bit, Process& process) {
        entry(bit).process = &process;
        frozen_ &= ~bit;
        poke(bit);
    }

    // One instant: everything due at the earliest wake-up, and all that this sets off without delay. False if
    // nothing will ever happen again.
    bool step() {
        woken_ &= ~frozen_;
        SessionTime next = woken_ != 0 ? now_ : kNever;
        std::uint32_t due = 0, bit = 1;
        for (const Entry& one : entries_) {  // no branch in it: which one is due first can't be foretold
            const SessionTime when = std::max(one.next, now_);  // what is late is due now
            const std::uint32_t same = when == next ? due | bit : due;
            due = when < next ? bit : same;
            next = std::min(next, when);
            bit <<= 1;
        }
        if (next == kNever) return false;
        instants_at_now_ = next > now_ ? 0 : instants_at_now_ + 1;
        if (instants_at_now_ > kMaxRoundsPerInstant) {
            throw std::logic_error("virtual time stands still: a process is always due");
        }
        now_ = next;
        run_instant(due);
        return true;
    }

    std::uint64_t ticks() const { return ticks_; }

  private:
    struct Entry {
        Process* process = nullptr;
        SessionTime next = kNever;  // also while it is frozen
    };
    Entry& entry(std::uint32_t bit) { return entries_[static_cast<std::size_t>(std::countr_zero(bit))]; }
    void run_instant(std::uint32_t due) {
        for (int round = 0; (due | (woken_ & ~frozen_)) != 0; ++round) {
            if (round > kMaxRoundsPerInstant)
                throw std::logic_error("virtual time stands still: endless messages");
            // One sweep in order of addition; what a process wakes behind itself waits for the next sweep.
            std::uint32_t ahead = ~std::uint32_t{0};
            while (const std::uint32_t pending = (due | (woken_ & ~frozen_)) & ahead) {
                const std::uint32_t bit = pending & -pending;  // the lowest
                ahead = ~(bit | (bit - 1));
                due &= ~bit;
                woken_ &= ~bit;
                Entry& ticked = entry(bit);
                ticked.process->tick(now_);
                ticked.next = (frozen_ & bit) != 0 ? kNever : ticked.process->next_wakeup();
                ++ticks_;
            }
        }
    }

    std::vector<Entry> entries_;
    std::uint32_t woken_ = 0, frozen_ = 0;
    SessionTime now_{};
    std::uint64_t ticks_ = 0;
    int instants_at_now_ = 0;
};

}  // namespace thimble
