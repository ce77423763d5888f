// The five nodes of a session: their programs, and the two ends of each one's control channel.
#pragma once

#include <array>

#include "common/network_settings.hpp"

namespace thimble {

struct NodeKind {
    Role role;
    const char* program;
    Port session_end, node_end;
};

// The master comes last: it starts once the others run.
inline constexpr std::array kNodes{
    NodeKind{Role::kNetem, "thimble-netem", Port::kSessionNetem, Port::kNetemControl},
    NodeKind{Role::kSlaveSim, "thimble-slave-sim", Port::kSessionSlave, Port::kSlaveControl},
    NodeKind{Role::kCutaneous, "thimble-cutaneous", Port::kSessionCutaneous, Port::kCutaneousControl},
    NodeKind{Role::kVisual, "thimble-visual", Port::kSessionVisual, Port::kVisualControl},
    NodeKind{Role::kMaster, "thimble-master", Port::kSessionMaster, Port::kMasterControl}};

inline constexpr auto kNodeRoles = [] {
    std::array<Role, kNodes.size()> roles{};
    for (std::size_t i = 0; i < roles.size(); ++i) roles[i] = kNodes[i].role;
    return roles;
}();

}  // namespace thimble
