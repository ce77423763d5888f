// Programs that only look: where they are, and whether they may be told.
#pragma once

#include <string>
#include <string_view>

#include "common/error.hpp"
#include "common/network_settings.hpp"
#include "common/runtime/udp_channel.hpp"
#include "netem/formats/text_lines.hpp"

namespace thimble {

// "9870" or "lab-pc:9870"; this machine where no host is named. Throws Error (usage) naming `option`.
inline Endpoint read_observer(const std::string& text, const std::string& option) {
    const std::size_t colon = text.rfind(':');
    const bool has_host = colon != std::string::npos;
    const std::string_view digits = std::string_view(text).substr(has_host ? colon + 1 : 0);
    Endpoint endpoint{has_host ? text.substr(0, colon) : "127.0.0.1", 0};
    const auto port = parse_integer(digits);
    if (port && *port >= 0 && *port <= 65535 && !endpoint.host.empty()) {
        endpoint.port = static_cast<std::uint16_t>(*port);
        return endpoint;
    }
    throw Error(ExitCode::kUsage, "{} {}: write PORT or HOST:PORT, with a port from 0 to 65535", option,
                text);
}

// Messages to observers are not protected. Throws Error (usage) naming `option` if `host` is another machine, or stands for
// all addresses of this one, and the session file does not allow that ([security] allow_unprotected_network).
inline void require_observer_here(const SecuritySettings& security, const std::string& host,
                                  const std::string& option) {
    if (security.allow_unprotected_network || !leaves_this_machine(host)) return;
    throw Error(ExitCode::kUsage,
                "{}: '{}' is not this machine alone, and what is said there has no protection: stay on "
                "127.0.0.1 (a tunnel, such as ssh -L, may begin there), or say [security] "
                "allow_unprotected_network = true in the session file (docs/security.md)",
                option, host);
}

}  // namespace thimble
