// Programs that only look: where they are, and whether they may be told.
#pragma once

#include <string>

#include "common/error.hpp"
#include "common/network_settings.hpp"
#include "common/runtime/udp_channel.hpp"

namespace thimble {

// Messages to observers are not protected. Throws Error (usage) naming `option` if `host` is another machine, or stands for
// all addresses of this one, and the session file does not allow that ([security] allow_unprotected_network).
inline void require_observer_here(const SecuritySettings& security, const std::string& host,
                                  const std::string& option) {
    if (security.allow_unprotected_network || !leaves_this_machine(host)) return;
    throw Error(ExitCode::kUsage,
                "{}: '{}' is not this machine alone, and this traffic has no protection: stay on 127.0.0.1 "
                "(use a tunnel such as ssh -L), or set [security] allow_unprotected_network = true in the "
                "session file (docs/security.md)",
                option, host);
}

}  // namespace thimble
