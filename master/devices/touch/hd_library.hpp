// libHD of OpenHaptics (vendor_library.hpp), 3D Systems' and Geomagic's and SensAble's before. The prototypes are our own. Sources of the
// facts: the "OpenHaptics Toolkit API Reference" 3.5 and public programs that open this library from Python and C.
//
// A function takes the device from hdMakeCurrentDevice() or hdBeginFrame(), and its failure from hdGetError(), which takes the oldest
// one off a stack. Positions are millimetres, forces newtons; x right, y up, z to the user.
#pragma once

#include <string>

#include "master/devices/vendor_library.hpp"

namespace thimble {

inline constexpr unsigned kHdNoDevice = 0xffffffffU;
inline constexpr unsigned kHdDone = 0, kHdContinue = 1;  // of a callback

enum HdParameter : unsigned {
    kHdButtons = 0x2000,
    kHdPosition = 0x2050,
    kHdModel = 0x2501,
    kHdSerial = 0x2504,
    kHdCalibrationStyle = 0x2555,
    kHdMostForce = 0x2603,
    kHdForce = 0x2700,
    kHdForceOutput = 0x4000,
};
enum HdCalibration : unsigned {
    kHdCalibrated = 0x5000,
    kHdNeedsUpdate = 0x5001,
    kHdNeedsUser = 0x5002,
};

// Motors that are warm, and a force, an impulse or a velocity that was too large: the device goes on.
inline constexpr unsigned kHdFirstPassing = 0x0200, kHdLastPassing = 0x0203;

struct HdError {
    unsigned code = 0;  // 0: none
    int inner = 0;
    unsigned device = kHdNoDevice;
};

using HdCallback = unsigned (*)(void* user);

struct HdFunctions {
    unsigned (*init_device)(const char* name) = nullptr;  // null: the default one
    void (*disable_device)(unsigned device) = nullptr;
    void (*make_current)(unsigned device) = nullptr;
    void (*begin_frame)(unsigned device) = nullptr;
    void (*end_frame)(unsigned device) = nullptr;
    void (*get_doubles)(unsigned parameter, double* values) = nullptr;
    void (*get_integers)(unsigned parameter, int* values) = nullptr;
    void (*set_doubles)(unsigned parameter, const double* values) = nullptr;
    const char* (*get_string)(unsigned parameter) = nullptr;
    void (*enable)(unsigned capability) = nullptr;
    void (*disable)(unsigned capability) = nullptr;
    HdError (*get_error)() = nullptr;
    const char* (*error_text)(unsigned code) = nullptr;
    unsigned (*check_calibration)() = nullptr;
    void (*update_calibration)(unsigned style) = nullptr;
    unsigned long (*schedule)(HdCallback callback, void* user, unsigned short priority) = nullptr;
    void (*unschedule)(unsigned long scheduled) = nullptr;
    void (*start_scheduler)() = nullptr;
    void (*stop_scheduler)() = nullptr;
};

class HdLibrary {
  public:
    // `file` alone if it is not empty. Otherwise: OPENHAPTICS_LIB (a file), the newest libHD.so* of lib/ under OH_SDK_BASE, of
    // /usr/lib, /usr/lib64 and /usr/local/lib, and then where the system looks. Throws Error (usage).
    explicit HdLibrary(const std::string& file);

    const HdFunctions& call() const { return functions_; }
    const std::string& file() const { return library_.file(); }
    // All failures since the last call are taken: the first that does not pass, or else the first. Empty: there was none.
    std::string take_error(bool* passes = nullptr) const;

  private:
    VendorLibrary library_;
    HdFunctions functions_;
};

}  // namespace thimble
