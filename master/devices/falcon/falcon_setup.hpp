// From power-up to the first report: settings of the FTDI chip, and the firmware, which the Falcon forgets without power. Blocks: for
// use before a session only. The firmware is Novint's and comes from a file the user names; nothing of it is here.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "master/devices/falcon/falcon_link.hpp"

namespace thimble {

// 1.5 Mbaud, and an answer within 1 ms instead of the chip's 16. False if the chip refuses.
bool set_falcon_running(FalconLink& link);

// Whether a firmware runs in it: some commands without force, and a report to any of them
// that is not its echo.
bool falcon_answers(FalconLink& link);

// Sends the image, which the device echoes byte by byte: the only check there is. Several times if need be. Throws Error (run failed):
// the step that failed, why, and what to do.
void load_falcon_firmware(FalconLink& link, std::span<const std::uint8_t> image);

// The file's bytes. Throws Error: usage, if it is missing or has another SHA-256 than was said; both are named.
std::vector<std::uint8_t> read_falcon_firmware(const std::string& path, const std::string& sha256);

}  // namespace thimble
