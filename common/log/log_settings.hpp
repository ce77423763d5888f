// Table [log] of a session file: what is written down of the messages (docs/log.md).
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "common/config.hpp"

namespace thimble {

enum class LoggedMessages : std::uint8_t {
    kNone,
    kControl,  // between the session and its nodes: orders, heartbeats, pages, clock probes, faults
    kAll,
};
inline constexpr std::array<std::string_view, 3> kLoggedMessagesNames{"none", "control", "all"};

struct LogSettings {
    LoggedMessages messages = LoggedMessages::kControl;
    std::string folder;
    Duration sync_period = std::chrono::seconds{1};
};

constexpr const char* to_string(LoggedMessages messages) {
    return kLoggedMessagesNames[static_cast<std::size_t>(messages)].data();
}
inline LogSettings read_log_settings(const ConfigFile& file) {
    const ConfigTable table = file.table("log");
    LogSettings settings;
    table.read("messages", settings.messages, kLoggedMessagesNames,
               "Messages that each program logs in nodes/*.mcap (docs/log.md).");
    table.read("folder", settings.folder,
               "Folder for the log of a program that was started without --log; empty: no log.");
    table.read("sync_period_s", settings.sync_period, 0, 60,
               "Time between two requests to write everything to the disk; 0: none.");
    return settings;
}

}  // namespace thimble
