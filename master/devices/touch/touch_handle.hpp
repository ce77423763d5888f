// The Touch of 3D Systems, and every other device that libHD opens. Its frame: x to the right, y up, z to the user.
//
// The library calls servo() about 1000 times a second in a thread of its own. Each call reads the position and sets the force between
// hdBeginFrame and hdEndFrame. It takes the force from the mailbox, so a master that hangs costs the force (DeviceMailbox).
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>

#include "master/devices/handle.hpp"
#include "master/devices/handle_settings.hpp"
#include "master/devices/mailbox_handle.hpp"
#include "master/devices/touch/hd_library.hpp"

namespace thimble {

// Opens the device and exchanges with it until it goes.
class TouchDevice : boost::noncopyable {
  public:
    // Throws Error: usage, if there is no library or no device.
    TouchDevice(const TouchSettings& settings, double force_limit_N);
    // Waits for a last call of the library's thread, which takes the force away.
    ~TouchDevice();

    DeviceMailbox& mailbox() { return mailbox_; }
    std::string name() const { return name_; }
    // The limit, or less where the device bears less.
    double most_N() const { return most_N_; }
    // The user's next step, until the device is calibrated; then empty. Not beside a trial.
    std::string calibrate();

  private:
    void open(const TouchSettings& settings);
    static unsigned servo(void* self);
    void exchange();
    void judge(SessionTime now);
    DeviceVector read_position_m();
    void push(const DeviceVector& force_N);
    [[noreturn]] void refuse(const std::string& why);

    HdLibrary library_;
    const HdFunctions& hd_;
    double most_N_;
    std::size_t axis_;  // of the device, the needle's
    unsigned device_ = kHdNoDevice;
    unsigned long scheduled_ = 0;
    std::string name_;
    DeviceMailbox mailbox_;
    int warned_frames_ = 0;    // without force, that are left
    SessionTime warned_at_{};  // the first of them
    std::atomic<bool> ending_{false}, ended_{false};
};

std::unique_ptr<Handle> open_touch(const TouchSettings& settings, double force_limit_N);

}  // namespace thimble
