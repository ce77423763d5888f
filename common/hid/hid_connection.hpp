// Finds a node's HID device, keeps it open, notices when it is gone and finds it again. Logic without a thread: whoever
// calls step() may be kept waiting (runtime/hid/hid_thread.hpp), so never a node's loop: listing what is plugged in takes
// milliseconds, and writing waits for the device.
#pragma once

#include <functional>

#include <boost/core/noncopyable.hpp>

#include "common/hid/hid_link.hpp"

namespace thimble {

// The part of a node that uses the device. All is called from within HidConnection::step().
class HidUser : boost::noncopyable {
  public:
    virtual ~HidUser() = default;

    // Which of `present` is the device; none: `trouble` says what is missing and what to do.
    virtual std::optional<std::size_t> choose(const std::vector<HidDevice>& present,
                                              std::string& trouble) = 0;
    // It has been opened. False: it is of no use, `trouble` says why.
    virtual bool attach(const HidDevice& device, std::span<const std::uint8_t> descriptor,
                        std::string& trouble) = 0;
    // Reads and writes for some milliseconds. False: it is gone.
    virtual bool turn(SessionTime now, HidLink& link) = 0;
    // After attach() and before the next one: the device is gone, or the node has ended.
    virtual void detach() = 0;
};

class HidConnection {
  public:
    static constexpr Duration kLookAgain = std::chrono::seconds{1};

    // `say`: for the log, each sentence once until something changes. Both outlive this.
    HidConnection(HidBus& bus, HidUser& user, std::function<void(const std::string&)> say);
    ~HidConnection();

    // A turn of the device, or a look for it. How long to wait before the next step.
    Duration step(SessionTime now);
    bool attached() const { return link_ != nullptr; }

  private:
    void look();
    void tell(const std::string& sentence);

    HidBus& bus_;
    HidUser& user_;
    std::function<void(const std::string&)> say_;
    std::unique_ptr<HidLink> link_;
    std::string device_, told_;
};

// The first of several entries of one path stands for it; entries that are not of `wanted` are left out.
std::vector<std::size_t> distinct_devices(const std::vector<HidDevice>& present,
                                          const std::function<bool(const HidDevice&)>& wanted);

}  // namespace thimble
