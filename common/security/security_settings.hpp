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
               "user-key and lab-key protect every datagram; user-key works for one user on one machine and "
               "needs no setup. none: anybody on the network can move the needle.");
    table.read("key_file", settings.key_file,
               "Key file, with the same path on every machine; empty: THIMBLE_LAB_KEY_FILE, else "
               "~/.config/thimble/lab.key.");
    table.read("allow_unprotected_network", settings.allow_unprotected_network,
               "Allow unprotected datagrams to leave this machine, with mode = \"none\"; also for a device "
               "on the network.");
    table.read("rig", settings.rig,
               "Name of this rig; programs of two rigs never talk, even with the same key. Empty: the hosts' "
               "names.");
    if (!settings.key_file.empty() && settings.mode != SecurityMode::kLabKey)
        table.fail("key_file", "has an effect with mode = \"lab-key\" only");
    return settings;
}

}  // namespace thimble
