// Programs that only look: where they are, and whether they may be told.
#pragma once

#include <string>

#include "common/network_settings.hpp"

namespace thimble {

// "9870" or "lab-pc:9870"; this machine where no host is named. Throws Error (usage) naming `option`.
Endpoint read_observer(const std::string& text, const std::string& option);

// Messages to observers are not protected. Throws Error (usage) naming `option` if `host` is another machine, or stands for
// all addresses of this one, and the session file does not allow that ([security] allow_unprotected_network).
void require_observer_here(const SecuritySettings& security, const std::string& host,
                           const std::string& option);

}  // namespace thimble
