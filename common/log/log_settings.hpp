// Table [log] of a session file: what is written down of the messages (docs/log.md).
#pragma once

#include <string>

#include "common/config.hpp"

namespace thimble {

enum class LoggedMessages : std::uint8_t {
    kNone,
    kControl,  // between the session and its nodes: orders, heartbeats, pages, clock probes, faults
    kAll,
};

struct LogSettings {
    LoggedMessages messages = LoggedMessages::kControl;
    // The folder for logs of nodes without --log. Empty: they write none.
    std::string folder;
    // So often the disk is asked to have it all; zero: whenever the system likes.
    Duration sync_period = std::chrono::seconds{1};
};

const char* to_string(LoggedMessages messages);
LogSettings read_log_settings(const ConfigFile& file);

}  // namespace thimble
