#include "master/devices/touch/hd_library.hpp"

#include <utility>

#include <fmt/format.h>

#include "common/own_program.hpp"

namespace thimble {
namespace {

constexpr VendorTexts kHdWords{
    "the Touch (libHD of OpenHaptics)", "it is not libHD of OpenHaptics",
    "OpenHaptics for Linux and the Touch Device Driver come from the maker (support.3dsystems.com): install "
    "both, or name the file in [handle.touch] library."};

LibraryPlaces hd_places() {
    LibraryPlaces places;
    if (std::string file = environment_text("OPENHAPTICS_LIB"); !file.empty())
        places.files.push_back(std::move(file));
    std::vector<std::filesystem::path> folders{"/usr/lib", "/usr/lib64", "/usr/local/lib"};
    if (const std::string sdk = environment_text("OH_SDK_BASE"); !sdk.empty())
        folders.insert(folders.begin(), std::filesystem::path(sdk) / "lib");
    for (const std::filesystem::path& folder : folders)
        places.add_folder(folder, library_files_in(folder, {"libHD.so"}), "no libHD.so*");
    places.files.emplace_back("libHD.so");
    return places;
}

constexpr int kMostErrors = 16;

}  // namespace

HdLibrary::HdLibrary(const std::string& file) : library_(file, hd_places, kHdWords) {
    HdFunctions& f = functions_;
    library_.need("hdInitDevice", f.init_device);
    library_.need("hdDisableDevice", f.disable_device);
    library_.need("hdMakeCurrentDevice", f.make_current);
    library_.need("hdBeginFrame", f.begin_frame);
    library_.need("hdEndFrame", f.end_frame);
    library_.need("hdGetDoublev", f.get_doubles);
    library_.need("hdGetIntegerv", f.get_integers);
    library_.need("hdSetDoublev", f.set_doubles);
    library_.need("hdGetString", f.get_string);
    library_.need("hdEnable", f.enable);
    library_.need("hdDisable", f.disable);
    library_.need("hdGetError", f.get_error);
    library_.need("hdGetErrorString", f.error_text);
    library_.need("hdCheckCalibration", f.check_calibration);
    library_.need("hdUpdateCalibration", f.update_calibration);
    library_.need("hdScheduleAsynchronous", f.schedule);
    library_.need("hdUnschedule", f.unschedule);
    library_.need("hdStartScheduler", f.start_scheduler);
    library_.need("hdStopScheduler", f.stop_scheduler);
}

std::string HdLibrary::take_error(bool* passes) const {
    const auto passing = [](unsigned code) { return code >= kHdFirstPassing && code <= kHdLastPassing; };
    unsigned chosen = functions_.get_error().code;
    if (chosen == 0) return "";
    for (int i = 0; i < kMostErrors; ++i) {
        const unsigned code = functions_.get_error().code;
        if (code == 0) break;
        if (passing(chosen)) chosen = passing(code) ? chosen : code;
    }
    if (passes != nullptr) *passes = passing(chosen);
    const char* words = functions_.error_text(chosen);
    return fmt::format("{} (error 0x{:04x})", words == nullptr ? "no message" : words, chosen);
}

}  // namespace thimble
