#include "master/devices/force_dimension/dhd_library.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <sys/utsname.h>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;

std::string environment(const char* name) {
    const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): before any thread
    return value == nullptr ? "" : value;
}

std::string machine() {
    utsname name{};
    return uname(&name) == 0 ? name.machine : "x86_64";
}

// In the order in which they are tried; `empty` gets the folders that have none.
std::vector<std::string> candidates(std::vector<std::string>& empty) {
    std::vector<std::string> files;
    if (const std::string file = environment("FORCEDIMENSION_LIB"); !file.empty()) files.push_back(file);
    std::vector<fs::path> folders;
    for (const char* name : {"FDSDK", "FORCEDIM_SDK"}) {
        const std::string sdk = environment(name);
        if (!sdk.empty()) folders.push_back(fs::path(sdk) / "lib/release" / ("lin-" + machine() + "-gcc"));
    }
    if (const std::string home = environment("HOME"); !home.empty())
        folders.push_back(fs::path(home) / ".local/lib");
    folders.emplace_back("/usr/local/lib");
    for (const fs::path& folder : folders) {
        const std::vector<fs::path> found = dhd_files_in(folder);
        for (const fs::path& file : found) files.push_back(file.string());
        if (found.empty()) empty.push_back(folder.string() + ": neither libdrd.so.* nor libdhd.so.*");
    }
    for (const char* name : {"libdrd.so.3", "libdhd.so.3", "libdrd.so", "libdhd.so"})
        files.emplace_back(name);
    return files;
}

// A file that is not there although its fully named one lies beside it: the SDK comes without the link.
std::string missing_link(const fs::path& file) {
    std::error_code ignored;
    if (!file.has_parent_path() || fs::exists(file, ignored)) return "";
    for (const fs::path& beside : dhd_files_in(file.parent_path())) {
        if (beside.filename().string().rfind(file.filename().string(), 0) != 0) continue;
        return fmt::format(" The link is missing: run `sudo ln -s {} {}`, or name {} itself.",
                           beside.filename().string(), file.string(), beside.filename().string());
    }
    return "";
}

std::string dl_words() {
    const char* words = dlerror();  // NOLINT(concurrency-mt-unsafe): before any thread
    return words == nullptr ? "no reason given" : words;
}

constexpr const char* kWhereToGetIt =
    "The Force Dimension SDK comes from the maker of the device (forcedimension.com, Software): unpack it "
    "and set FDSDK to its folder, or name the file in [handle.force_dimension] library.";

}  // namespace

std::vector<fs::path> dhd_files_in(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code absent;
    for (const auto& entry : fs::directory_iterator(folder, absent)) {
        const std::string name = entry.path().filename().string();
        if (name.rfind("libdrd.so.", 0) == 0 || name.rfind("libdhd.so.", 0) == 0)
            files.push_back(entry.path());
    }
    // drd after dhd by name, and 3.17 after 3.9 by version.
    std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
        return strverscmp(a.filename().c_str(), b.filename().c_str()) > 0;
    });
    return files;
}

DhdLibrary::DhdLibrary(const std::string& file) {
    std::vector<std::string> tried;
    const std::vector<std::string> files = file.empty() ? candidates(tried) : std::vector{file};
    tried.reserve(tried.size() + files.size());
    for (const std::string& one : files) {
        handle_ = dlopen(one.c_str(), RTLD_NOW | RTLD_LOCAL);
        if (handle_ != nullptr) {
            file_ = one;
            break;
        }
        tried.push_back(dl_words() + missing_link(one));
    }
    if (handle_ == nullptr) {
        throw Error(ExitCode::kUsage, "no library for the Force Dimension handle:\n  {}\n{}",
                    fmt::join(tried, "\n  "), kWhereToGetIt);
    }
    bind();
}

DhdLibrary::~DhdLibrary() {
    if (handle_ != nullptr) dlclose(handle_);
}

DhdLibrary::DhdLibrary(DhdLibrary&& other) noexcept
    : handle_(std::exchange(other.handle_, nullptr)),
      file_(std::move(other.file_)),
      functions_(other.functions_) {}

void DhdLibrary::bind() {
    const auto optional = [this](const char* name, auto& function) {
        function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(handle_, name));
    };
    const auto needed = [&](const char* name, auto& function) {
        optional(name, function);
        if (function != nullptr) return;
        const std::string file = std::exchange(file_, "");
        dlclose(std::exchange(handle_, nullptr));
        throw Error(ExitCode::kUsage,
                    "{} has no function {}: it is no Force Dimension library, or older than SDK 3.6. {}",
                    file, name, kWhereToGetIt);
    };
    DhdFunctions& f = functions_;
    needed("dhdOpenID", f.open_id);
    needed("dhdClose", f.close);
    needed("dhdStop", f.stop);
    needed("dhdGetDeviceCount", f.device_count);
    needed("dhdGetSystemType", f.system_type);
    needed("dhdGetSystemName", f.system_name);
    needed("dhdGetSerialNumber", f.serial_number);
    needed("dhdGetPosition", f.position);
    needed("dhdGetLinearVelocity", f.linear_velocity);
    needed("dhdSetForce", f.set_force);
    needed("dhdEnableForce", f.enable_force);
    needed("dhdSetBrakes", f.set_brakes);
    needed("dhdSetGravityCompensation", f.set_gravity_compensation);
    needed("dhdSetMaxForce", f.set_max_force);
    needed("dhdGetStatus", f.status);
    needed("dhdErrorGetLast", f.error_code);
    needed("dhdErrorGetStr", f.error_text);
    optional("dhdEnableExpertMode", f.enable_expert_mode);
    optional("dhdDisableExpertMode", f.disable_expert_mode);
    optional("dhdSetWatchdog", f.set_watchdog);
    optional("dhdGetButton", f.button);
    optional("dhdGetSDKVersion", f.sdk_version);
}

std::string DhdLibrary::version() const {
    if (functions_.sdk_version == nullptr) return "of unknown version";
    int major = 0, minor = 0, release = 0, revision = 0;
    functions_.sdk_version(&major, &minor, &release, &revision);
    return fmt::format("{}.{}.{}.{}", major, minor, release, revision);
}

}  // namespace thimble
