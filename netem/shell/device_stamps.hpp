// When the kernel handed each packet to a TUN device. The device gives no stamps. A packet socket beside
// it notes the beginning and the time of each packet. Its memory is shared with the kernel, so a stamp needs no system call.
#pragma once

#include <cstdint>
#include <string>

#include <boost/core/noncopyable.hpp>

#include "common/channel.hpp"
#include "common/runtime/stamp_clock.hpp"

namespace thimble {

// The socket, in the network namespace of the calling thread; -1 where the kernel or the user's rights do not allow one.
int open_stamp_socket(const std::string& device);

class DeviceStamps : boost::noncopyable {
  public:
    // A negative socket: every packet was handed over when it is read. Does not close it.
    explicit DeviceStamps(int socket);
    ~DeviceStamps();

    // Once per round of reading.
    void update() { clock_.update(read_clock_pair()); }
    // Of a packet just read, `now` at the latest. Packets come in the kernel's order; those that it dropped are passed over.
    SessionTime of(Bytes packet, SessionTime now);
    std::uint64_t missing() const { return missing_; }  // packets for which `now` had to do

  private:
    const std::uint8_t* entry(std::size_t ahead) const;
    void release(std::size_t count);

    std::uint8_t* ring_ = nullptr;
    std::size_t next_ = 0;
    std::uint64_t missing_ = 0;
    StampClock clock_;
};

}  // namespace thimble
