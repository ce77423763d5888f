// The stop lines of a virtual session's six programs: everybody hears everybody, without delay.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/stop_line.hpp"
#include "session/virtual/virtual_protection.hpp"

namespace thimble {

class VirtualStops {
  public:
    VirtualStops() {
        for (std::size_t i = 0; i < out_.size(); ++i) out_[i].connect(in_[i]);
    }

    // `process` has join_stop_line() and the role that owns kStopPorts[i]; stops wake `bit`.
    template <class Process>
    void join(Process& process, Role role, const VirtualProtection& protection, std::uint32_t* mask,
              std::uint32_t bit) {
        StopOutlets outlets{};
        for (std::size_t i = 0; i < out_.size(); ++i) {
            outlets[i] = protection.stop_end(role, out_[i], StopEnd::kSpeaks);
        }
        QueueChannel& own = in_[place(role)];
        own.wake(mask, bit);
        process.join_stop_line(*protection.stop_end(role, own, StopEnd::kListens), outlets);
    }

  private:
    static std::size_t place(Role role) {
        std::size_t i = 0;
        while (owner(kStopPorts[i]) != role) ++i;
        return i;
    }

    // One sending end is enough for all: it holds nothing.
    std::array<QueueChannel, kStopPorts.size()> in_, out_;
};

}  // namespace thimble
