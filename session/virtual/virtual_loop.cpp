#include "session/virtual/virtual_loop.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <stdexcept>

namespace thimble {
namespace {

// Messages that chase each other without any delay would hold the clock for ever: a program error.
constexpr int kMaxRoundsPerInstant = 10000;

}  // namespace

std::uint32_t VirtualLoop::add(Process& process) {
    assert(entries_.size() < 32);
    entries_.push_back({&process, process.next_wakeup()});
    return std::uint32_t{1} << (entries_.size() - 1);
}

bool VirtualLoop::step() {
    woken_ &= ~frozen_;
    SessionTime next = woken_ != 0 ? now_ : kNever;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
        if ((frozen_ >> i & 1U) == 0) next = std::min(next, entries_[i].next);
    }
    if (next == kNever) return false;
    instants_at_now_ = next > now_ ? 0 : instants_at_now_ + 1;
    if (instants_at_now_ > kMaxRoundsPerInstant) {
        throw std::logic_error("virtual time stands still: a process is always due");
    }
    now_ = std::max(now_, next);
    std::uint32_t due = 0;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
        if (entries_[i].next <= now_) due |= std::uint32_t{1} << i;
    }
    run_instant(due & ~frozen_);
    return true;
}

void VirtualLoop::thaw(std::uint32_t bit) {
    if ((frozen_ & bit) != 0) woken_ |= bit;
    frozen_ &= ~bit;
}

void VirtualLoop::replace(std::uint32_t bit, Process& process) {
    entries_[static_cast<std::size_t>(std::countr_zero(bit))].process = &process;
    frozen_ &= ~bit;
    poke(bit);
}

void VirtualLoop::run_instant(std::uint32_t due) {
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
            Entry& entry = entries_[static_cast<std::size_t>(std::countr_zero(bit))];
            entry.process->tick(now_);
            entry.next = entry.process->next_wakeup();
            ++ticks_;
        }
    }
}

}  // namespace thimble
