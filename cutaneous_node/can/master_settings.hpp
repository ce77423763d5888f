// The master's settings of its drives.
#pragma once

#include <cstdint>
#include <vector>

#include "common/time.hpp"
#include "cutaneous_node/can/cia402.hpp"

namespace thimble {

struct CanMasterSettings {
    std::vector<std::uint8_t> nodes;  // all different, 1 to 126
    DriveMode mode = DriveMode::kSyncTorque;
    Duration cycle = std::chrono::milliseconds{4};  // of SYNC
    // Silence that is a loss, in both directions: what the master allows a drive and a drive the master.
    Duration silent_after = std::chrono::milliseconds{100};
    Duration boot_limit = std::chrono::seconds{3};
    Duration answer_limit = std::chrono::milliseconds{500};  // of one SDO, asked up to five times
    Duration enable_limit = std::chrono::seconds{2};
    std::uint8_t master_node = 127;
};

}  // namespace thimble
