// The Falcon on a real USB, by libusb: found and claimed.
#pragma once

#include <memory>
#include <string>

#include "master/devices/falcon/falcon_link.hpp"

namespace thimble {

struct ClaimedFalcon {
    std::unique_ptr<FalconLink> link;  // releases the device when it goes
    std::string serial;
};

// The Falcon with this serial number; empty: the only one. Throws Error (usage) with what is missing and what to do.
ClaimedFalcon claim_falcon(const std::string& serial);

// No Falcon is on the USB.
bool falcon_is_absent();

}  // namespace thimble
