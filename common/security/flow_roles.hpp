// The two ends of each flow, regardless of relays between them.
#pragma once

#include "common/network_settings.hpp"

namespace thimble {

// Where a datagram that is sent to `port` is read: behind the relay, which has no key.
constexpr Port final_port(Port port) {
    switch (port) {
        case Port::kNetemNeedle:
            return Port::kSlaveNeedle;
        case Port::kNetemForceMaster:
            return Port::kMasterForce;
        case Port::kNetemForceCutaneous:
            return Port::kCutaneousForce;
        case Port::kNetemForceVisual:
            return Port::kVisualForce;
        default:
            return port;
    }
}

// The role that may seal messages for `port`.
inline Role speaker(Port port) {
    if (port == Port::kSlaveNeedle) return Role::kMaster;
    const Role heard = flow(port).hears;
    return heard == Role::kNetem && owner(port) != Role::kSession ? Role::kSlaveSim : heard;
}

// The one-way flows, whose keys come from the session; all others have a way back and agree on theirs.
inline constexpr std::array kKeyedFlows{
    Port::kSessionRecord,       Port::kMasterForce, Port::kMasterPerceptCutaneous,
    Port::kMasterPerceptVisual, Port::kSlaveNeedle, Port::kCutaneousForce,
    Port::kVisualForce,         Port::kVisualBeep,  Port::kMasterHand};

}  // namespace thimble
