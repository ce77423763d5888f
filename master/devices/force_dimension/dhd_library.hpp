// Force Dimension's library (vendor_library.hpp). The prototypes are our own, after the public description of SDK 3.17 (C linkage; what is
// no default argument to dlsym: the device's number is always given, -1 for the default one).
//
// A call succeeds if it returns >= 0: 1 from dhdGetPosition is "too soon, the last value again" (kTimeGuard), 2 from dhdSetForce is
// "applied as far as the motors can" (kMotorSaturated).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "master/devices/vendor_library.hpp"

namespace thimble {

inline constexpr int kDhdTimeGuard = 1;
inline constexpr int kDhdMotorSaturated = 2;
inline constexpr std::size_t kDhdStatusCount = 32;  // the SDK fills 17; room for later ones

// Places in the status array.
enum DhdStatus : std::size_t {
    kDhdPower = 0,
    kDhdConnected = 1,
    kDhdReset = 3,  // waits for calibration
    kDhdForce = 5,
    kDhdError = 9,
    kDhdForceOffCause = 14,  // 1 button, 2 velocity, 3 watchdog, 4 software, 5 USB, 6 dead man's switch
};

// Metres, newtons, metres per second. Null: this version has no such function (the last five only).
struct DhdFunctions {
    int (*open_id)(char index) = nullptr;  // the device's number
    int (*close)(char id) = nullptr;
    int (*stop)(char id) = nullptr;  // no force, motors shorted
    int (*device_count)() = nullptr;
    int (*system_type)(char id) = nullptr;
    const char* (*system_name)(char id) = nullptr;
    int (*serial_number)(unsigned short* serial, char id) = nullptr;
    int (*position)(double* x, double* y, double* z, char id) = nullptr;
    int (*linear_velocity)(double* x, double* y, double* z, char id) = nullptr;
    int (*set_force)(double x, double y, double z, char id) = nullptr;
    int (*enable_force)(unsigned char on, char id) = nullptr;
    int (*set_brakes)(int on, char id) = nullptr;
    int (*set_gravity_compensation)(int on, char id) = nullptr;
    int (*set_max_force)(double force_N, char id) = nullptr;
    int (*status)(int* status, char id) = nullptr;
    int (*error_code)() = nullptr;
    const char* (*error_text)(int code) = nullptr;
    int (*enable_expert_mode)() = nullptr;
    int (*disable_expert_mode)() = nullptr;
    int (*set_watchdog)(unsigned char ticks, char id) = nullptr;  // of 125 us; 0: none
    int (*button)(int index, char id) = nullptr;                  // 1: pressed
    void (*sdk_version)(int* major, int* minor, int* release, int* revision) = nullptr;
};

class DhdLibrary {
  public:
    // `file` alone if it is not empty. Otherwise, the newest of each place: FORCEDIMENSION_LIB (a file), lib/release/lin-<machine>-gcc
    // under FDSDK and FORCEDIM_SDK, ~/.local/lib, /usr/local/lib, and then where the system looks. Throws Error (usage), which
    // names every place that was looked at, the missing link, or the missing function.
    explicit DhdLibrary(const std::string& file);

    const DhdFunctions& call() const { return functions_; }
    const std::string& file() const { return library_.file(); }
    // "3.17.0.1234", or "of unknown version".
    std::string version() const;

  private:
    VendorLibrary library_;
    DhdFunctions functions_;
};

// libdrd.so.* and libdhd.so.* in this folder, drd (which holds the other's functions too) first, newest first.
std::vector<std::filesystem::path> dhd_files_in(const std::filesystem::path& folder);

}  // namespace thimble
