// The meaning of a port's silence or errors, and of all ports of a host together.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace thimble {

enum class PortAnswer : std::uint8_t { kAnswers, kNobodyListens, kNoRoute, kProhibited, kSilent };
const char* to_string(PortAnswer answer);

// Of one port, after a few hellos.
struct PortEvidence {
    std::uint32_t welcomes = 0;
    int error = 0;  // errno of the last failed send or of the last ICMP message about one; 0: none
    bool by_icmp = false;
    int icmp_code = 0;  // of "destination unreachable" (RFC 792, RFC 1812)
};

PortAnswer classify(const PortEvidence& evidence);

// One sentence about all ports: where the fault lies and what to do. Empty if every port answers.
std::string diagnose(std::span<const PortAnswer> ports, const std::string& host, unsigned base_port);

}  // namespace thimble
