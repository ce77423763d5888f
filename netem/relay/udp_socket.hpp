// A UDP socket that receives many datagrams per system call, each with the moment at which the kernel had it.
#pragma once

#include <cstdint>

#include "netem/relay/udp_address.hpp"

namespace thimble {

class UdpSocket {
  public:
    UdpSocket() = default;
    // Throws Error (network) if the port is taken.
    static UdpSocket listening(const UdpAddress& local);
    // To one peer from a port of the kernel's choice; datagrams of others never arrive. Throws Error (network).
    static UdpSocket connected(const UdpAddress& remote);

    ~UdpSocket();
    UdpSocket(UdpSocket&& other) noexcept;
    UdpSocket& operator=(UdpSocket&& other) noexcept;

    int descriptor() const { return descriptor_; }
    UdpAddress local() const;
    // Datagrams that came and found no room in the kernel (SO_MEMINFO).
    std::uint64_t dropped_by_kernel() const;

  private:
    explicit UdpSocket(int descriptor) : descriptor_(descriptor) {}
    static UdpSocket open();
    int descriptor_ = -1;
};

}  // namespace thimble
