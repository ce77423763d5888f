#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/runtime/hid/hid_thread.hpp"
#include "master/devices/force_dimension/force_dimension_handle.hpp"
#include "master/devices/handle.hpp"
#include "master/devices/haply/haply_handle.hpp"
#include "master/devices/hid/hid_hand.hpp"
#include "master/devices/pointer_handle.hpp"
#include "master/devices/simulated_handle.hpp"
#include "master/devices/touch/touch_handle.hpp"
#ifdef THIMBLE_DEVICES
#include "master/devices/falcon/falcon_handle.hpp"
#endif

namespace thimble {
namespace {

// A person's SpaceMouse or gamepad, and the thread that talks to it.
struct HidParts {
    HidParts(const HandleSettings& settings, const RuntimeSettings& runtime)
        : hand(settings.hid), thread(hand, runtime) {}
    HidHand hand;
    HidThread thread;
};

class OpenedHid final : private HidParts, public HidHandle {
  public:
    OpenedHid(const HandleSettings& settings, const RuntimeSettings& runtime)
        : HidParts(settings, runtime), HidHandle(settings, settings.hid, hand) {}
    void describe(nlohmann::ordered_json& report) const override {
        report["hid"] = {{"attachments", hand.attachments()}, {"bad_reports", hand.bad_reports()}};
    }
};

std::shared_ptr<Handle> open_falcon_here([[maybe_unused]] const HandleSettings& settings,
                                         [[maybe_unused]] const RuntimeSettings& runtime) {
#ifdef THIMBLE_DEVICES
    return open_falcon(settings.falcon, settings.force_limit_N, runtime);
#else
    throw Error(ExitCode::kUsage,
                "this build has no driver for the Falcon ([handle] device = \"falcon\"): install "
                "libusb-1.0-0-dev and libsodium-dev and build with -DTHIMBLE_DEVICES=ON");
#endif
}

}  // namespace

std::shared_ptr<Handle> open_handle(const HandleSettings& settings, const OperatorParameters& person,
                                    const RuntimeSettings& runtime) {
    switch (settings.kind) {
        case HandleKind::kPointer:
        case HandleKind::kKeyboard:
            return std::make_shared<PointerHandle>(settings);
        case HandleKind::kHid:
            return std::make_shared<OpenedHid>(settings, runtime);
        case HandleKind::kForceDimension:
            return std::make_shared<ForceDimensionHandle>(settings.force_dimension, settings.force_limit_N,
                                                          DhdLibrary(settings.force_dimension.library));
        case HandleKind::kFalcon:
            return open_falcon_here(settings, runtime);
        case HandleKind::kRos2:
            throw Error(ExitCode::kUsage,
                        "[handle] device = \"ros2\" needs thimble-ros2-master instead of thimble-master; "
                        "'thimble run' starts it by itself (docs/ros2.md)");
        case HandleKind::kHaply:
            return open_haply(settings.haply, settings.force_limit_N, runtime);
        case HandleKind::kTouch:
            return open_touch(settings.touch, settings.force_limit_N);
        case HandleKind::kSimulated:
            break;
    }
    return std::make_shared<SimulatedHandle>(settings, person);
}

}  // namespace thimble
