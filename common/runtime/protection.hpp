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
// One line on stderr if nothing is protected.
void warn_if_unprotected(const NetworkSettings& settings);

// None in mode "none". Reads the lab key; from then on this process leaves no core dump and cannot be looked into by others.
// Throws Error as read_lab_key() does.
std::unique_ptr<Security> make_security(const SecuritySettings& settings);

}  // namespace thimble
