// Hears what anybody sends to one UDP port over loopback, as who stands on the wire does.
#pragma once

#include <cstdint>
#include <vector>

namespace thimble {

class WireEar {
  public:
    // Not what comes from `own_port`. Throws Error (network) where this user may not listen (CAP_NET_RAW).
    WireEar(std::uint16_t port, std::uint16_t own_port);
    ~WireEar();
    WireEar(const WireEar&) = delete;
    WireEar& operator=(const WireEar&) = delete;

    // The newest datagram since the last call; empty if there was none. Never waits.
    const std::vector<std::uint8_t>& newest();

  private:
    int socket_ = -1;
    std::vector<std::uint8_t> buffer_, datagram_;
};

}  // namespace thimble
