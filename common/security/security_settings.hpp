// Table [security] of a session file: whether datagrams are protected, and by which key.
#pragma once

#include <string>

#include "common/config.hpp"

namespace thimble {

enum class SecurityMode { kNone, kLabKey };

struct SecuritySettings {
    SecurityMode mode = SecurityMode::kNone;
    bool mode_given = false;
    bool allow_unprotected_network =
        false;             // mode "none" between machines, said a second time; a device's own protocol
    std::string key_file;  // empty: THIMBLE_LAB_KEY_FILE, or default_lab_key_file()
};

inline SecuritySettings read_security_settings(const ConfigFile& file) {
    const ConfigTable table = file.table("security");
    SecuritySettings settings;
    settings.mode_given = table.has("mode");
    table.read("mode", settings.mode, {"none", "lab-key"},
               "lab-key seals every datagram; none is refused where [network] names another machine.");
    table.read(
        "key_file", settings.key_file,
        "The same path on every machine; empty: THIMBLE_LAB_KEY_FILE, else ~/.config/thimble/lab.key.");
    table.read("allow_unprotected_network", settings.allow_unprotected_network,
               "With mode = \"none\" said as well, datagrams may leave this machine, a device's own too.");
    if (!settings.key_file.empty() && settings.mode == SecurityMode::kNone)
        table.fail("key_file", "is of no use without mode = \"lab-key\"");
    return settings;
}

}  // namespace thimble
