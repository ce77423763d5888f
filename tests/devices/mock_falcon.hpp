// A Falcon that is not there, below the real libusb: what libusb asks the kernel's usbfs is answered here, and the transfers by an
// emulated Falcon.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <list>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "tests/devices/mock_bed.hpp"
#include "tests/unit/handles/falcon_emulator.hpp"

namespace thimble {

class MockFalcon {
  public:
    // The `number`th device on the bus, from 2. `bed` outlives it.
    MockFalcon(MockBed& bed, int number, std::string serial);
    ~MockFalcon();
    MockFalcon(const MockFalcon&) = delete;
    MockFalcon& operator=(const MockFalcon&) = delete;

    // With the emulator, while no transfer is served.
    template <class Use>
    auto with(Use&& use) {
        const std::lock_guard lock(mutex_);
        return use(emulator_);
    }
    void unplug();  // its files in /sys go too
    void be_claimed_by_somebody(bool claimed = true) { busy_ = claimed; }
    std::string file() const;  // as the program sees it: /dev/bus/usb/001/002

  private:
    struct Urb {
        UMockdevIoctlData *urb = nullptr, *buffer = nullptr;
        std::uint64_t address = 0;
        UMockdevIoctlClient* client = nullptr;  // whose it is
    };
    static void on_vanished(UMockdevIoctlBase* base, UMockdevIoctlClient* client, void* self);
    static int on_ioctl(UMockdevIoctlBase* base, UMockdevIoctlClient* client, void* self);
    int serve(UMockdevIoctlClient* client);
    bool submit(UMockdevIoctlClient* client);
    void control(Urb urb);
    void finish(Urb urb, int status, const std::vector<std::uint8_t>& data, std::size_t offset, int length);
    bool discard(UMockdevIoctlData* argument);
    bool reap(UMockdevIoctlClient* client);
    void feed(const UMockdevIoctlClient* client);
    void signal_done();
    static void forget(Urb urb);

    MockBed* bed_;
    std::string system_path_, path_, serial_;
    std::mutex mutex_;
    FalconEmulator emulator_;
    UMockdevIoctlBase* base_ = nullptr;
    int fifo_ = -1;
    bool full_ = false;  // the fifo: nothing to reap
    std::atomic<bool> busy_{false};
    std::list<Urb> pending_in_;
    std::deque<Urb> done_;
    std::set<UMockdevIoctlClient*> held_;
};

}  // namespace thimble
