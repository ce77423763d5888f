#include "common/log/log_settings.hpp"

namespace thimble {

const char* to_string(LoggedMessages messages) {
    switch (messages) {
        case LoggedMessages::kNone:
            return "none";
        case LoggedMessages::kControl:
            return "control";
        case LoggedMessages::kAll:
            break;
    }
    return "all";
}

LogSettings read_log_settings(const ConfigFile& file) {
    const ConfigTable table = file.table("log");
    LogSettings settings;
    settings.messages = static_cast<LoggedMessages>(
        table.choice("messages", static_cast<std::size_t>(settings.messages), {"none", "control", "all"}));
    settings.folder = table.text("folder", settings.folder);
    settings.sync_period =
        table.seconds("sync_period_s", settings.sync_period, Duration{0}, std::chrono::minutes{1});
    return settings;
}

}  // namespace thimble
