// The table [cutaneous.touchdiver]: where WEART's middleware listens, and which thimbles press (docs/fingertip.md).
#pragma once

#include <cstdint>
#include <string>

#include "common/config.hpp"

namespace thimble {

enum class GloveSide : std::uint8_t { kLeft, kRight };
enum class Thimble : std::uint8_t { kThumb, kIndex, kMiddle };

struct TouchDiverSettings {
    std::string host = "127.0.0.1";
    std::uint16_t port = 13031;
    GloveSide acting = GloveSide::kRight, other = GloveSide::kLeft;  // as the middleware calls the devices
    Thimble push = Thimble::kIndex, pull = Thimble::kThumb;
    double full_scale_N = 5;
};

inline TouchDiverSettings read_touchdiver_settings(const ConfigTable& table) {
    TouchDiverSettings settings;
    table.read("host", settings.host, "Machine where WEART's middleware or WEART-App runs.");
    table.read("port", settings.port, 1, 65535, "TCP port of that program.");
    table.read("acting_hand", settings.acting, {"left", "right"},
               "CF: side of the device on the hand at the handle, as the middleware calls it.");
    table.read(
        "other_hand", settings.other, {"left", "right"},
        "CCF: side of the device on the other hand; same as acting_hand: one device, moved between hands.");
    table.read("push_thimble", settings.push, {"thumb", "index", "middle"},
               "Finger that is pressed while the needle goes in.");
    table.read("pull_thimble", settings.pull, {"thumb", "index", "middle"},
               "Finger that is pressed while the needle comes out.");
    table.read(
        "full_scale_N", settings.full_scale_N, 0.1, 50,
        "Force for the middleware's value 1 (a); if this is too large, the device presses too little.");
    return settings;
}

}  // namespace thimble
