// A CAN adapter of the slcan kind (Lawicel's words), played on a pseudo-terminal: the kernel's slcan driver at its other end
// makes a CAN interface of it, with real error frames and a real bus-off.
#pragma once

#include <string>

#include "cutaneous_node/can/can_bus.hpp"

namespace thimble {

class SlcanPty final : public CanBus {
  public:
    // `lies`: between the frames it says what no adapter should, and cuts one frame in kCutEvery short.
    // Needs the right to attach a line discipline (CAP_NET_ADMIN) and the module slcan. Throws Error (network).
    explicit SlcanPty(bool lies = false);
    ~SlcanPty() override;

    // Sends a data or error frame; bus-off and error-passive in the adapter's own form.
    void send(const CanFrame& frame) override;
    bool receive(SessionTime now, CanFrame& frame) override;
    void flush() override {}  // nothing waits
    bool down() const override { return false; }

    int file_descriptor() const { return adapter_; }
    const std::string& interface() const { return interface_; }

  private:
    static constexpr std::uint64_t kCutEvery = 97;

    void say(const std::string& line);
    void lie(std::string& line);

    int adapter_ = -1, kernel_ = -1;
    bool lies_;
    std::uint64_t said_ = 0;
    std::string interface_, heard_;
};

}  // namespace thimble
