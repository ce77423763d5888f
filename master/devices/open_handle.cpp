#include "master/devices/open_handle.hpp"

#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/runtime/hid/hid_thread.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "master/devices/force_dimension/force_dimension_handle.hpp"
#include "master/devices/hid/hid_hand.hpp"
#include "master/devices/pointer_handle.hpp"
#include "master/devices/simulated_handle.hpp"
#ifdef THIMBLE_DEVICES
#include "master/devices/falcon/falcon_handle.hpp"
#endif

namespace thimble {
namespace {

// No device with a name, nothing to wait for.
class OpenWithoutDevice : public OpenHandle {
  public:
    HandFollower* follower() override { return nullptr; }
    std::string name() const override { return {}; }
    std::string awaits() override { return {}; }
    void describe(nlohmann::ordered_json& /*report*/) const override {}
};

class OpenSimulated final : public OpenWithoutDevice {
  public:
    OpenSimulated(const HandleSettings& settings, const OperatorParameters& person)
        : handle_(settings, person) {}
    HapticDevice& device() override { return handle_; }
    OperatorPort& person() override { return handle_; }

  private:
    SimulatedHandle handle_;
};

class OpenPointer final : public OpenWithoutDevice {
  public:
    explicit OpenPointer(const HandleSettings& settings) : handle_(settings) {}
    HapticDevice& device() override { return handle_; }
    OperatorPort& person() override { return handle_; }
    HandFollower* follower() override { return &handle_; }

  private:
    PointerHandle handle_;
};

// A person's SpaceMouse or gamepad, and the thread that talks to it.
class OpenHid final : public OpenWithoutDevice {
  public:
    OpenHid(const HandleSettings& settings, const RuntimeSettings& runtime)
        : hand_(settings.hid), handle_(settings, settings.hid, hand_), thread_(hand_, runtime) {}
    HapticDevice& device() override { return handle_; }
    OperatorPort& person() override { return handle_; }
    void describe(nlohmann::ordered_json& report) const override {
        report["hid"] = {{"attachments", hand_.attachments()}, {"bad_reports", hand_.bad_reports()}};
    }

  private:
    HidHand hand_;
    HidHandle handle_;
    HidThread thread_;
};

class OpenReal final : public OpenHandle {
  public:
    explicit OpenReal(std::unique_ptr<RealHandle> handle) : handle_(std::move(handle)) {}
    HapticDevice& device() override { return *handle_; }
    OperatorPort& person() override { return *handle_; }
    HandFollower* follower() override { return nullptr; }
    std::string name() const override { return handle_->name(); }
    std::string awaits() override { return handle_->awaits(); }
    void describe(nlohmann::ordered_json& report) const override { handle_->describe(report["handle"]); }

  private:
    std::unique_ptr<RealHandle> handle_;
};

std::unique_ptr<RealHandle> open_falcon_here([[maybe_unused]] const HandleSettings& settings,
                                             [[maybe_unused]] const RuntimeSettings& runtime) {
#ifdef THIMBLE_DEVICES
    return open_falcon(settings.falcon, settings.force_limit_N, [runtime] { ask_for_realtime(runtime); });
#else
    throw Error(ExitCode::kUsage,
                "this build has no driver for the Falcon ([handle] device = \"falcon\"): install "
                "libusb-1.0-0-dev and "
                "libsodium-dev and build with -DTHIMBLE_DEVICES=ON");
#endif
}

}  // namespace

std::unique_ptr<OpenHandle> open_handle(const HandleSettings& settings, const OperatorParameters& person,
                                        const RuntimeSettings& runtime) {
    switch (settings.kind) {
        case HandleKind::kPointer:
            return std::make_unique<OpenPointer>(settings);
        case HandleKind::kHid:
            return std::make_unique<OpenHid>(settings, runtime);
        case HandleKind::kForceDimension:
            return std::make_unique<OpenReal>(
                std::make_unique<ForceDimensionHandle>(settings.force_dimension, settings.force_limit_N,
                                                       DhdLibrary(settings.force_dimension.library)));
        case HandleKind::kFalcon:
            return std::make_unique<OpenReal>(open_falcon_here(settings, runtime));
        case HandleKind::kSimulated:
            break;
    }
    return std::make_unique<OpenSimulated>(settings, person);
}

}  // namespace thimble
