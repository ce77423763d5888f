// Keys as files: one line, "thimble-lab-key-1 " and 32 bytes in base64, readable by its owner alone. The lab key is made by a person,
// the user key by the first program that needs it.
#pragma once

#include <filesystem>
#include <string_view>

#include "common/security/secret.hpp"

namespace thimble {

// XDG_CONFIG_HOME/thimble/lab.key, by default ~/.config/thimble/lab.key. Throws Error (usage) without a home.
std::filesystem::path default_lab_key_file();
// The file that systemd hands a service as the credential "lab.key"; else the setting if it is not empty (a leading "~/" is the
// home), else the environment's THIMBLE_LAB_KEY_FILE, else the default.
std::filesystem::path lab_key_file(std::string_view setting);
// Where a new key goes: the same without the credential, because systemd makes that one.
std::filesystem::path new_lab_key_file(std::string_view setting);

// A key of random bits in a new file, and whatever folders it needs. Throws Error: usage, if there is a file of that name, as a key is
// never overwritten; data, if it cannot be written, and nothing is left behind.
void create_lab_key(const std::filesystem::path& path, const RandomBytes& random);
// Throws Error: usage, if there is none, if it is not ours or not ours alone, with the command that mends it; data, if it is no
// key.
LabKey read_lab_key(const std::filesystem::path& path);

// XDG_STATE_HOME/thimble/user.key, by default ~/.local/state/thimble/user.key. Throws Error (usage) without a home.
std::filesystem::path user_key_file();
// Without that file no program of this user has a session under the user key. Throws as user_key_file() does.
bool has_user_key();
// Reads that file, and makes it where there is none. Programs that start at once get one key. Throws Error: usage, if it cannot be
// made or as read_lab_key() does; data, if it is no key.
LabKey own_user_key(const RandomBytes& random);

}  // namespace thimble
