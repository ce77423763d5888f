// The handle that a session file names, found and made ready, with whoever holds it: the one place that chooses.
#pragma once

#include <memory>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "common/runtime/runtime_settings.hpp"
#include "master/devices/hand_follower.hpp"
#include "master/devices/handle_settings.hpp"
#include "master/devices/haptic_device.hpp"
#include "master/operator/operator_parameters.hpp"
#include "master/operator/operator_port.hpp"

namespace thimble {

class OpenHandle {
  public:
    virtual ~OpenHandle() = default;
    OpenHandle() = default;
    OpenHandle(const OpenHandle&) = delete;
    OpenHandle& operator=(const OpenHandle&) = delete;

    virtual HapticDevice& device() = 0;
    virtual OperatorPort& person() = 0;
    // The follower of a person's pointer; null: none.
    virtual HandFollower* follower() = 0;
    // Of a real one: as RealHandle.
    virtual std::string name() const = 0;
    virtual std::string awaits() = 0;
    // Adds its part, if it has one, to the node's report.
    virtual void describe(nlohmann::ordered_json& report) const = 0;
};

// A driver with a thread is scheduled as `runtime` says. Throws Error with what is missing and what to do about it; usage, if this
// build has no driver for it (THIMBLE_DEVICES=OFF).
std::unique_ptr<OpenHandle> open_handle(const HandleSettings& settings, const OperatorParameters& person,
                                        const RuntimeSettings& runtime);

}  // namespace thimble
