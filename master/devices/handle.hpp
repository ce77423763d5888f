// A handle and the operator who holds it. By default that is a person. A person needs no call to begin, to feel, or to be done:
// the session sees when the needle is withdrawn.
#pragma once

#include <memory>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "common/runtime/runtime_settings.hpp"
#include "master/devices/handle_settings.hpp"
#include "master/devices/haptic_device.hpp"
#include "master/operator/operator_parameters.hpp"
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

// The handle that a session file names, found and made ready: the one place that chooses.

// A driver with a thread is scheduled as `runtime` says. Throws Error with what is missing and what to do about it; usage, if this
// build has no driver for it (THIMBLE_DEVICES=OFF).
std::shared_ptr<Handle> open_handle(const HandleSettings& settings, const OperatorParameters& person,
                                    const RuntimeSettings& runtime);

}  // namespace thimble
