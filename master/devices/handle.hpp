// A handle and the operator who holds it. By default that is a person. A person needs no call to begin, to feel, or to be done:
// the session sees when the needle is withdrawn.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "master/devices/haptic_device.hpp"
#include "master/operator/operator_port.hpp"

namespace thimble {

class Handle : public HapticDevice, public OperatorPort {
  public:
    void start_trial(SessionTime /*now*/, const OperatorTask& /*task*/) override {}
    void perceive(SessionTime /*now*/, const Percept& /*percept*/) override {}
    bool finished() const override { return false; }

    // The follower of a person's pointer; null: none.
    virtual HandFollower* follower() { return nullptr; }
    // Of a real one, which device was found, for the log: "omega.3, serial 1234, ...".
    virtual std::string name() const { return {}; }
    // The steps that the user must do before use, and their progress; empty: none. Asked before the node says that it is
    // ready, over and over.
    virtual std::string awaits() { return {}; }
    // Adds its part, if it has one, to the node's report.
    virtual void describe(nlohmann::ordered_json& /*report*/) const {}
};

}  // namespace thimble
