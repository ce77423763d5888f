// Whether a program's datagrams may go unprotected, and what protects them ([security] of a session file).
#pragma once

#include <memory>

#include "common/network_settings.hpp"
#include "common/security/security.hpp"

namespace thimble {

// Throws Error (usage) if datagrams would leave this machine unprotected without the file's saying so twice.
void require_protection(const NetworkSettings& settings);
// The same of a device's own protocol, which nothing here protects.
void require_protection_of_device(const SecuritySettings& settings, const std::string& host);
// One line on stderr if datagrams leave this machine unprotected. Only users of this machine reach loopback.
void warn_if_unprotected(const NetworkSettings& settings);

// From now on this process leaves no core dump, and others of the same user cannot look into it: before a key is read or made.
// Throws Error (run failed) if the system does not allow that.
void hide_memory();

// None in mode "none". Reads the lab key; after hide_memory(). Throws Error as both do.
std::unique_ptr<Security> make_security(const SecuritySettings& settings);

}  // namespace thimble
