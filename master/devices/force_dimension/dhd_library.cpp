#include "master/devices/force_dimension/dhd_library.hpp"

#include <sys/utsname.h>
#include <utility>

#include <fmt/format.h>

#include "common/own_program.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;

std::string machine() {
    utsname name{};
    return uname(&name) == 0 ? name.machine : "x86_64";
}

LibraryPlaces dhd_places() {
    LibraryPlaces places;
    if (std::string file = environment_text("FORCEDIMENSION_LIB"); !file.empty())
        places.files.push_back(std::move(file));
    std::vector<fs::path> folders;
    for (const char* name : {"FDSDK", "FORCEDIM_SDK"}) {
        const std::string sdk = environment_text(name);
        if (!sdk.empty()) folders.push_back(fs::path(sdk) / "lib/release" / ("lin-" + machine() + "-gcc"));
    }
    if (const std::string home = environment_text("HOME"); !home.empty())
        folders.push_back(fs::path(home) / ".local/lib");
    folders.emplace_back("/usr/local/lib");
    for (const fs::path& folder : folders)
        places.add_folder(folder, dhd_files_in(folder), "neither libdrd.so.* nor libdhd.so.*");
    for (const char* name : {"libdrd.so.3", "libdhd.so.3", "libdrd.so", "libdhd.so"})
        places.files.emplace_back(name);
    return places;
}

constexpr VendorTexts kDhdWords{
    "the Force Dimension handle", "it is not a Force Dimension library, or older than SDK 3.6",
    "The Force Dimension SDK comes from the maker of the device (forcedimension.com, Software): unpack it "
    "and set FDSDK to its folder, or name the file in [handle.force_dimension] library."};

}  // namespace

// drd after dhd by name.
std::vector<fs::path> dhd_files_in(const fs::path& folder) {
    return library_files_in(folder, {"libdrd.so.", "libdhd.so."});
}

DhdLibrary::DhdLibrary(const std::string& file) : library_(file, dhd_places, kDhdWords) {
    DhdFunctions& f = functions_;
    library_.need("dhdOpenID", f.open_id);
    library_.need("dhdClose", f.close);
    library_.need("dhdStop", f.stop);
    library_.need("dhdGetDeviceCount", f.device_count);
    library_.need("dhdGetSystemType", f.system_type);
    library_.need("dhdGetSystemName", f.system_name);
    library_.need("dhdGetSerialNumber", f.serial_number);
    library_.need("dhdGetPosition", f.position);
    library_.need("dhdGetLinearVelocity", f.linear_velocity);
    library_.need("dhdSetForce", f.set_force);
    library_.need("dhdEnableForce", f.enable_force);
    library_.need("dhdSetBrakes", f.set_brakes);
    library_.need("dhdSetGravityCompensation", f.set_gravity_compensation);
    library_.need("dhdSetMaxForce", f.set_max_force);
    library_.need("dhdGetStatus", f.status);
    library_.need("dhdErrorGetLast", f.error_code);
    library_.need("dhdErrorGetStr", f.error_text);
    library_.bind("dhdEnableExpertMode", f.enable_expert_mode);
    library_.bind("dhdDisableExpertMode", f.disable_expert_mode);
    library_.bind("dhdSetWatchdog", f.set_watchdog);
    library_.bind("dhdGetButton", f.button);
    library_.bind("dhdGetSDKVersion", f.sdk_version);
}

std::string DhdLibrary::version() const {
    if (functions_.sdk_version == nullptr) return "of unknown version";
    int major = 0, minor = 0, release = 0, revision = 0;
    functions_.sdk_version(&major, &minor, &release, &revision);
    return fmt::format("{}.{}.{}.{}", major, minor, release, revision);
}

}  // namespace thimble
