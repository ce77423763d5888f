// UDP ports that no other test takes, where several run side by side.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <unistd.h>
#include <utility>

#include "common/error.hpp"
#include "common/runtime/udp_channel.hpp"

namespace thimble {

// A socket on that UDP port of 127.0.0.1. Throws Error (network) if another program has it.
inline std::unique_ptr<UdpChannel> listen_at(unsigned port) {
    return std::make_unique<UdpChannel>(Endpoint{"127.0.0.1", static_cast<std::uint16_t>(port)},
                                        Endpoint{"127.0.0.1", 0});
}

// The first number below `count`, from one of this process's own on, for which `claim` gives a socket and throws no Error.
inline std::pair<unsigned, std::unique_ptr<UdpChannel>> first_free(
    unsigned count, const std::function<std::unique_ptr<UdpChannel>(unsigned)>& claim) {
    for (unsigned i = 0; i < count; ++i) {
        const unsigned at = (static_cast<unsigned>(getpid()) + i) % count;
        try {
            return {at, claim(at)};
        } catch (const Error&) {
            continue;
        }
    }
    throw std::runtime_error("no free UDP ports");
}

// Ports for two conditions that were free when this object was made. A socket on the last one keeps the block.
class GuardedPorts {
  public:
    GuardedPorts() {
        auto [block, guard] = first_free(kBlocks, [](unsigned at) {
            const unsigned base = kFirstPort + at * kPortsPerBlock;
            auto last = listen_at(base + kPortsPerBlock - 1);
            for (unsigned i = 0; i < kPortsPerBlock - 1; ++i) listen_at(base + i);
            return last;
        });
        base_ = static_cast<std::uint16_t>(kFirstPort + block * kPortsPerBlock);
        guard_ = std::move(guard);
    }
    std::uint16_t base() const { return base_; }

  private:
    // Below the range from which the kernel draws ports for sockets that did not ask for one.
    static constexpr unsigned kFirstPort = 10000, kPortsPerBlock = 128, kBlocks = 150;

    std::uint16_t base_ = 0;
    std::unique_ptr<UdpChannel> guard_;
};

}  // namespace thimble
