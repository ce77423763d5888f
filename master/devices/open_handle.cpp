#include "master/devices/open_handle.hpp"

#include "common/error.hpp"
#include "master/devices/force_dimension/force_dimension_handle.hpp"
#ifdef THIMBLE_DEVICES
#include "master/devices/falcon/falcon_handle.hpp"
#endif

namespace thimble {

std::unique_ptr<RealHandle> open_handle(const HandleSettings& settings,
                                        [[maybe_unused]] const std::function<void()>& prepare_thread) {
    if (settings.kind == HandleKind::kForceDimension) {
        return std::make_unique<ForceDimensionHandle>(settings.force_dimension, settings.force_limit_N,
                                                      DhdLibrary(settings.force_dimension.library));
    }
    if (settings.kind == HandleKind::kFalcon) {
#ifdef THIMBLE_DEVICES
        return open_falcon(settings.falcon, settings.force_limit_N, prepare_thread);
#else
        throw Error(ExitCode::kUsage,
                    "this build has no driver for the Falcon: install libusb-1.0-0-dev and libsodium-dev and "
                    "build with "
                    "-DTHIMBLE_DEVICES=ON");
#endif
    }
    return nullptr;
}

}  // namespace thimble
