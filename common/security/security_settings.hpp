// Table [security] of a session file: whether datagrams are protected, and by which key.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "common/config.hpp"

namespace thimble {

enum class SecurityMode { kUserKey, kLabKey, kNone };
inline constexpr std::array<std::string_view, 3> kSecurityModes{"user-key", "lab-key", "none"};
inline std::string_view to_string(SecurityMode mode) {
    return kSecurityModes[static_cast<std::size_t>(mode)];
}

struct SecuritySettings {
    SecurityMode mode = SecurityMode::kUserKey;
    // mode "none" between machines, said a second time; a device's own protocol
    bool allow_unprotected_network = false;
    std::string key_file;  // empty: THIMBLE_LAB_KEY_FILE, or default_lab_key_file()
    std::string rig;       // empty: the hosts stand for it
};

inline SecuritySettings read_security_settings(const ConfigFile& file) {
    const ConfigTable table = file.table("security");
    SecuritySettings settings;
    table.read("mode", settings.mode, kSecurityModes,
               "user-key and lab-key seal every datagram; user-key is for one user on one machine and needs "
               "nothing. none: anybody there may move the needle.");
    table.read(
        "key_file", settings.key_file,
        "The same path on every machine; empty: THIMBLE_LAB_KEY_FILE, else ~/.config/thimble/lab.key.");
    table.read("allow_unprotected_network", settings.allow_unprotected_network,
               "With mode = \"none\" said as well, datagrams may leave this machine, a device's own too.");
    table.read("rig", settings.rig,
               "Name of this rig; programs of two rigs never talk, under one key too. Empty: the hosts.");
    if (!settings.key_file.empty() && settings.mode != SecurityMode::kLabKey)
        table.fail("key_file", "is of no use without mode = \"lab-key\"");
    return settings;
}

}  // namespace thimble
