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

// In the order of kNodeRoles (session_process.hpp).
inline constexpr std::array kNodes{
    NodeKind{Role::kNetem, "thimble-netem", Port::kSessionNetem, Port::kNetemControl},
    NodeKind{Role::kSlaveSim, "thimble-slave-sim", Port::kSessionSlave, Port::kSlaveControl},
    NodeKind{Role::kCutaneous, "thimble-cutaneous", Port::kSessionCutaneous, Port::kCutaneousControl},
    NodeKind{Role::kVisual, "thimble-visual", Port::kSessionVisual, Port::kVisualControl},
    NodeKind{Role::kMaster, "thimble-master", Port::kSessionMaster, Port::kMasterControl}};

}  // namespace thimble
