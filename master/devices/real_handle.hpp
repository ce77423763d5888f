// A handle with a person's hand on it: nobody simulates the operator, who needs no words from us to begin, to feel, or to be
// done. The session sees when the needle is withdrawn.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "master/devices/haptic_device.hpp"
#include "master/operator/operator_port.hpp"

namespace thimble {

class RealHandle : public HapticDevice, public OperatorPort {
  public:
    void start_trial(SessionTime /*now*/, const OperatorTask& /*task*/) override {}
    void perceive(SessionTime /*now*/, const Percept& /*percept*/) override {}
    bool finished() const override { return false; }

    // Which device was found, for the log: "omega.3, serial 1234, ...".
    virtual std::string name() const = 0;
    // The steps that the user must do before use, and their progress; empty: none. Asked before the node says that it is
    // ready, over and over.
    virtual std::string awaits() = 0;
    // Its part of the node's report.
    virtual void describe(nlohmann::ordered_json& report) const = 0;
};

}  // namespace thimble
