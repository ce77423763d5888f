// A CAN interface of this machine (SocketCAN), never blocking, with the controller's error frames.
#pragma once

#include <string>

#include "common/runtime/listener.hpp"
#include "cutaneous_node/can/can_bus.hpp"

namespace thimble {

class SocketCanBus final : public CanBus, public Listener {
  public:
    // Throws Error (network) with the interface and what to do if there is none, or it is down.
    explicit SocketCanBus(const std::string& interface);
    ~SocketCanBus() override;

    void send(const CanFrame& frame) override;
    bool receive(SessionTime now, CanFrame& frame) override;
    void flush() override {}  // nothing waits
    bool down() const override { return down_; }
    int file_descriptor() const override { return socket_; }

  private:
    void open(const std::string& interface);

    int socket_ = -1;
    bool down_ = false;
};

}  // namespace thimble
