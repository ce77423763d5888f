// The two ends of each flow, regardless of relays between them.
#pragma once

#include <algorithm>
#include <array>

#include "common/network_settings.hpp"

namespace thimble {

// Where a datagram that is sent to `port` is read: behind the relay, which cannot read it.
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

// A flow under a key of its own. A hop is one half of the way through the relay: to the relay, or from it.
struct KeyedFlow {
    Port port = Port::kCount;  // where it is read: by its last receiver, or at the end of the hop
    bool hop = false;

    bool operator==(const KeyedFlow&) const = default;
};

// The role that may seal messages of a flow.
inline Role speaker(const KeyedFlow& keyed) {
    const Role heard = flow(keyed.port).hears;
    if (keyed.hop || heard != Role::kNetem) return heard;
    return keyed.port == Port::kSlaveNeedle ? Role::kMaster : Role::kSlaveSim;
}

// The one-way flows, whose keys come from the session. Stops use the rig's key (stop_seal.hpp); all others have a way back
// and agree on theirs.
inline constexpr std::array<KeyedFlow, 17> kKeyedFlows{{{Port::kSessionRecord},
                                                        {Port::kMasterForce},
                                                        {Port::kMasterPerceptCutaneous},
                                                        {Port::kMasterPerceptVisual},
                                                        {Port::kSlaveNeedle},
                                                        {Port::kCutaneousForce},
                                                        {Port::kVisualForce},
                                                        {Port::kVisualScene},
                                                        {Port::kMasterHand},
                                                        {Port::kNetemNeedle, true},
                                                        {Port::kSlaveNeedle, true},
                                                        {Port::kNetemForceMaster, true},
                                                        {Port::kMasterForce, true},
                                                        {Port::kNetemForceCutaneous, true},
                                                        {Port::kCutaneousForce, true},
                                                        {Port::kNetemForceVisual, true},
                                                        {Port::kVisualForce, true}}};

// Whether datagrams come to `port` on a hop.
constexpr bool ends_hop(Port port) {
    const KeyedFlow hop{port, true};
    return std::find(kKeyedFlows.begin(), kKeyedFlows.end(), hop) != kKeyedFlows.end();
}

}  // namespace thimble
