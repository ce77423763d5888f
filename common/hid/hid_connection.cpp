#include "common/hid/hid_connection.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace thimble {

HidConnection::HidConnection(HidBus& bus, HidUser& user, std::function<void(const std::string&)> say)
    : bus_(bus), user_(user), say_(std::move(say)) {}

HidConnection::~HidConnection() {
    if (link_) user_.detach();
}

Duration HidConnection::step(SessionTime now) {
    if (!link_) look();
    if (!link_) return kLookAgain;
    if (user_.turn(now, *link_)) return Duration::zero();
    user_.detach();
    link_.reset();
    tell(fmt::format("{} is gone: plug it in again, it is looked for each second", device_));
    return kLookAgain;
}

void HidConnection::look() {
    const std::vector<HidDevice> present = bus_.list();
    std::string trouble;
    const auto chosen = user_.choose(present, trouble);
    if (!chosen) return tell(trouble);
    const HidDevice& device = present.at(*chosen);
    std::string why;
    auto link = bus_.open(device, why);
    if (!link) {
        return tell(fmt::format(
            "{} may not be opened ({}): sudo cp deploy/udev/70-thimble-hid.rules /etc/udev/rules.d/ && sudo "
            "udevadm control --reload && sudo udevadm trigger, or plug it in anew",
            to_string(device), why));
    }
    if (!user_.attach(device, bus_.descriptor(device), trouble)) return tell(trouble);
    link_ = std::move(link);
    device_ = to_string(device);
    tell(device_ + " is in use");
}

void HidConnection::tell(const std::string& sentence) {
    if (sentence == told_) return;
    told_ = sentence;
    say_(sentence);
}

std::vector<std::size_t> distinct_devices(const std::vector<HidDevice>& present,
                                          const std::function<bool(const HidDevice&)>& wanted) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < present.size(); ++i) {
        const auto same = [&](std::size_t other) { return present[other].path == present[i].path; };
        if (wanted(present[i]) && std::none_of(found.begin(), found.end(), same)) found.push_back(i);
    }
    return found;
}

}  // namespace thimble
