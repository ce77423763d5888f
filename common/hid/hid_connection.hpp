// Finds a node's HID device, keeps it open, notices its loss and finds it again. Logic without a thread. step() may
// block, because listing devices takes milliseconds and writing waits for the device. So a thread calls it
// (runtime/hid/hid_thread.hpp), never a node's loop.
#pragma once

#include <algorithm>
#include <functional>
#include <string_view>

#include <boost/core/noncopyable.hpp>
#include <fmt/format.h>

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
    // Asked after each turn: what is wrong with the device and what to do, for the log; empty: nothing.
    virtual std::string_view complaint() const { return {}; }
    // After attach() and before the next one: the device is gone, or the node has ended.
    virtual void detach() = 0;
};

class HidConnection {
  public:
    static constexpr Duration kLookAgain = std::chrono::seconds{1};

    // `say`: for the log, each sentence once until something changes. Both outlive this.
    HidConnection(HidBus& bus, HidUser& user, std::function<void(const std::string&)> say)
        : bus_(bus), user_(user), say_(std::move(say)) {}
    ~HidConnection() {
        if (link_) user_.detach();
    }

    // A turn of the device, or a look for it. How long to wait before the next step.
    Duration step(SessionTime now) {
        if (!link_) look();
        if (!link_) return kLookAgain;
        if (user_.turn(now, *link_)) {
            if (const auto words = user_.complaint(); !words.empty())
                tell(fmt::format("{} {}", device_, words));
            return Duration::zero();
        }
        user_.detach();
        link_.reset();
        tell(fmt::format("{} is gone: plug it in again; thimble looks for it once a second", device_));
        return kLookAgain;
    }

    bool attached() const { return link_ != nullptr; }

  private:
    void look() {
        const std::vector<HidDevice> present = bus_.list();
        std::string trouble;
        const auto chosen = user_.choose(present, trouble);
        if (!chosen) return tell(trouble);
        const HidDevice& device = present.at(*chosen);
        std::string why;
        auto link = bus_.open(device, why);
        if (!link) {
            return tell(fmt::format(
                "this user may not open {} ({}): sudo cp deploy/udev/70-thimble-hid.rules /etc/udev/rules.d/ "
                "&& sudo udevadm control --reload && sudo udevadm trigger, or unplug it and plug it in again",
                to_string(device), why));
        }
        if (!user_.attach(device, bus_.descriptor(device), trouble)) return tell(trouble);
        link_ = std::move(link);
        device_ = to_string(device);
        tell(device_ + " is in use");
    }

    void tell(const std::string& sentence) {
        if (sentence == told_) return;
        told_ = sentence;
        say_(sentence);
    }

    HidBus& bus_;
    HidUser& user_;
    std::function<void(const std::string&)> say_;
    std::unique_ptr<HidLink> link_;
    std::string device_, told_;
};

// The first of several entries of one path stands for it; entries that are not of `wanted` are left out.
inline std::vector<std::size_t> distinct_devices(const std::vector<HidDevice>& present,
                                                 const std::function<bool(const HidDevice&)>& wanted) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < present.size(); ++i) {
        const auto same = [&](std::size_t other) { return present[other].path == present[i].path; };
        if (wanted(present[i]) && std::none_of(found.begin(), found.end(), same)) found.push_back(i);
    }
    return found;
}

}  // namespace thimble
