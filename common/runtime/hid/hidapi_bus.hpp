// HID devices by hidapi, in its hidraw flavour: Linux' own HID drivers stay in place.
#pragma once

#include "common/hid/hid_link.hpp"

namespace thimble {

// Throws Error (usage) in a build without hidapi (THIMBLE_DEVICES=OFF).
std::unique_ptr<HidBus> make_hidapi_bus();

}  // namespace thimble
