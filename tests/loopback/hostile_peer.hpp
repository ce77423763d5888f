// Unexpected datagrams: broken bytes, impossible numbers, orders from strangers.
#pragma once

#include <memory>
#include <vector>

#include "common/codec.hpp"
#include "common/network_settings.hpp"
#include "common/runtime/udp_channel.hpp"

namespace thimble {

// Encoded with a header of the caller's choice.
std::vector<std::uint8_t> datagram(const Header& header, const Body& body);

// One of each that no receiver may decode: too short, cut off, of a foreign format, not finite, out of range,
// too long.
std::vector<std::vector<std::uint8_t>> broken_datagrams();

// Sends to every port of a session, from the peers' own host and from a foreign one.
class HostilePeer {
  public:
    explicit HostilePeer(std::uint16_t base_port);
    void send_broken();          // everything broken, to every port
    void send_from_strangers();  // broken nowhere, but from 127.0.0.2
    // Flawless messages with the right role on the flows that a running HF trial has in use, but of another
    // instance: a needle elsewhere, wild forces, an end to everything.
    void send_as_second_sender(std::uint32_t trial);

  private:
    UdpChannel& to(Port port) { return *near_[static_cast<std::size_t>(port)]; }

    std::vector<std::unique_ptr<UdpChannel>> near_, far_;  // by Port
    std::vector<std::vector<std::uint8_t>> broken_;
    std::uint32_t sequence_ = 0;
};

}  // namespace thimble
