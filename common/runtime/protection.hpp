// Whether a program's datagrams may go unprotected, and what protects them ([security] of a session file).
#pragma once

#include <memory>
#include <string_view>

#include "common/network_settings.hpp"
#include "common/security/security.hpp"

namespace thimble {

// Throws Error (usage) if datagrams would leave this machine unprotected without the file's saying so twice, or under a user key,
// which other machines do not have.
void require_protection(const NetworkSettings& settings);
// Throws Error (usage) if they would leave it unprotected at all: before a real handle, or a robot, is opened.
void require_protection_of_handle(const NetworkSettings& settings);
// The same for a device's own protocol, which Thimble does not encrypt.
void require_protection_of_device(const SecuritySettings& settings, const std::string& host);
// The same of DDS at `interface`, which key `interface` of `table` names.
void require_protection_of_dds(const SecuritySettings& settings, std::string_view table,
                               const std::string& interface);
// One line on stderr in mode "none".
void warn_if_unprotected(const NetworkSettings& settings);
// For lock-step, where a datagram's port shows whether a program of the session sent it: by default none needs a key.
NetworkSettings without_user_key(NetworkSettings settings);

// From now on this process leaves no core dump, and others of the same user cannot look into it: before a key is read or made.
// Throws Error (run failed) if the system does not allow that.
void hide_memory();

// None in mode "none". Reads the key, of a lab after hide_memory(): every program of this user can read the user key anyway.
// Throws Error as these do.
std::unique_ptr<Security> make_security(const NetworkSettings& settings);

}  // namespace thimble
