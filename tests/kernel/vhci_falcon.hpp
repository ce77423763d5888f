// An emulated Falcon as a USB device of the running kernel: the module vhci_hcd takes a socket, and who answers there by the USB/IP
// protocol (Documentation/usb/usbip_protocol.rst of the kernel) is the device. A thread answers.
#pragma once

#include <cstdint>
#include <deque>
#include <mutex>
#include <thread>
#include <vector>

#include "tests/unit/handles/falcon_emulator.hpp"

namespace thimble {

class VhciFalcon {
  public:
    // Plugs it into this port of vhci_hcd. Throws std::runtime_error if the kernel has none.
    explicit VhciFalcon(int port);
    ~VhciFalcon() { unplug(); }
    VhciFalcon(const VhciFalcon&) = delete;
    VhciFalcon& operator=(const VhciFalcon&) = delete;

    void unplug();
    template <class Use>
    auto with(Use&& use) {
        const std::lock_guard lock(mutex_);
        return use(emulator_);
    }

  private:
    struct Request;
    struct Waiting {
        std::uint32_t sequence;
        std::size_t length;
    };
    void serve();
    bool take();
    void submit(const Request& request, std::vector<std::uint8_t> data);
    void control(const Request& request);
    void feed();
    void feed_status();
    void reply(std::uint32_t command, std::uint32_t sequence, int status,
               const std::vector<std::uint8_t>& data, std::size_t length);

    int socket_ = -1;
    std::mutex mutex_;
    FalconEmulator emulator_;
    std::deque<Waiting> waiting_in_;
    std::thread thread_;
};

}  // namespace thimble
