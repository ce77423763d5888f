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

SecuritySettings read_security_settings(const ConfigFile& file);

}  // namespace thimble
