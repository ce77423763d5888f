// A libHD.so of our own with a scripted stylus behind it, which the real dlopen finds. THIMBLE_FAKE_HD names its
// script: lines "key value", read when a device is opened. A fault begins once the file `fault` names exists. The
// scheduler is a thread that calls each millisecond. Once the file `go` names exists, the hand goes in along
// -z by `press` metres within 1 s. Once the file `back` names exists, it comes out again within 1 s. It writes
// its orders to the file `log` names. When it did not call for 0.15 s, the file `pauses` names says how long.
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <mutex>
#include <string>
#include <thread>

namespace {

using Clock = std::chrono::steady_clock;
constexpr double kPi = 3.14159265358979323846, kWay_s = 1, kPause_s = 0.15;
constexpr unsigned kNone = 0xffffffffU, kCommunication = 0x0302, kWarm = 0x0200, kFast = 0x0203;

double passed_s(Clock::time_point since) {
    return std::chrono::duration<double>(Clock::now() - since).count();
}

struct Device {
    std::map<std::string, std::string> script;
    std::atomic<unsigned> error{0};
    std::atomic<bool> running{false}, warned{false}, calibrated{true};
    unsigned (*callback)(void*) = nullptr;
    void* user = nullptr;
    std::thread servo;
    std::mutex logging;
    std::string last_force;
    Clock::time_point went_in{}, came_out{};

    void read_script() {
        script.clear();
        error = 0;
        warned = false;
        last_force.clear();
        went_in = came_out = {};
        const char* path = std::getenv("THIMBLE_FAKE_HD");
        std::ifstream file(path == nullptr ? "" : path);
        std::string key, value;
        while (file >> key && std::getline(file >> std::ws, value)) script[key] = value;
        calibrated = number("uncalibrated", 0) == 0;
    }
    double number(const char* key, double fallback) const {
        const auto found = script.find(key);
        return found == script.end() ? fallback : std::strtod(found->second.c_str(), nullptr);
    }
    std::string text(const char* key) const {
        const auto found = script.find(key);
        return found == script.end() ? "" : found->second;
    }
    void say(const std::string& line) {
        const std::lock_guard lock(logging);
        std::ofstream(text("log"), std::ios::app) << line << '\n';
    }
    bool there(const char* key) const { return std::ifstream(text(key)).good(); }
    bool fails(const char* mode) const { return text("mode") == mode && there("fault"); }
    // 0 to 1 within kWay_s after the file exists.
    double way(Clock::time_point& began, const char* key) {
        if (began == Clock::time_point{} && there(key)) began = Clock::now();
        if (began == Clock::time_point{}) return 0;
        return (1 - std::cos(kPi * std::fmin(passed_s(began) / kWay_s, 1))) / 2;
    }
    double depth_m() { return number("press", 0) * (way(went_in, "go") - way(came_out, "back")); }
    void note_pause(double pause_s) {
        if (pause_s > kPause_s) std::ofstream(text("pauses"), std::ios::app) << pause_s << '\n';
    }
    void run() {
        for (Clock::time_point called = Clock::now(); running;) {
            note_pause(passed_s(called));
            called = Clock::now();
            if (!fails("stalled") && callback != nullptr && callback(user) == 0) callback = nullptr;
            std::this_thread::sleep_for(std::chrono::milliseconds{1});
        }
    }
};

Device& device() {
    static Device one;
    return one;
}

}  // namespace

// The name is that of the driver, since the sanitizer compares types of functions by name.
namespace thimble {
struct HdError {
    unsigned code;
    int inner;
    unsigned device;
};
}  // namespace thimble

extern "C" {

unsigned hdInitDevice(const char* name) {
    device().read_script();
    if (device().number("devices", 1) == 0) {
        device().error = kCommunication;
        return kNone;
    }
    device().say(std::string("init ") + (name == nullptr ? "default" : name));
    return 7;
}
void hdDisableDevice(unsigned /*device*/) { device().say("disable device"); }
void hdMakeCurrentDevice(unsigned /*device*/) {}
void hdBeginFrame(unsigned /*device*/) {
    if (device().fails("unplugged")) device().error = kCommunication;
    if (device().fails("warm")) device().error = kWarm;
    if (device().fails("fast") && !device().warned.exchange(true)) device().error = kFast;
}
void hdEndFrame(unsigned /*device*/) {}
void hdGetDoublev(unsigned parameter, double* values) {
    Device& d = device();
    if (parameter == 0x2603) values[0] = d.number("most_force", 3.3);
    if (parameter != 0x2050) return;
    values[0] = 1000 * d.number("x", 0);
    values[1] = d.fails("garbled") ? std::numeric_limits<double>::quiet_NaN() : 1000 * d.number("y", 0);
    values[2] = 1000 * (d.number("z", 0) - d.depth_m());
}
void hdGetIntegerv(unsigned parameter, int* values) {
    if (parameter == 0x2000) *values = device().there("button_file") ? 2 : 0;
    if (parameter == 0x2555) *values = 4;
}
void hdSetDoublev(unsigned parameter, const double* values) {
    if (parameter != 0x2700) return;
    char line[100];
    std::snprintf(line, sizeof line, "force %.2f %.2f %.2f", values[0] + 0.0, values[1] + 0.0,
                  values[2] + 0.0);
    if (line == device().last_force) return;
    device().last_force = line;
    device().say(line);
}
const char* hdGetString(unsigned parameter) { return parameter == 0x2501 ? "Touch" : "T1"; }
void hdEnable(unsigned /*capability*/) { device().say("enable"); }
void hdDisable(unsigned /*capability*/) { device().say("disable"); }
thimble::HdError hdGetError() { return {device().error.exchange(0), 0, 7}; }
const char* hdGetErrorString(unsigned code) {
    if (code == kFast) return "Velocity is too high";
    return code == kCommunication ? "Device communication error" : "Motors are too warm";
}
unsigned hdCheckCalibration() {
    if (device().calibrated) return 0x5000;
    return device().there("in_well") ? 0x5001 : 0x5002;
}
void hdUpdateCalibration(unsigned style) {
    device().say("calibrate " + std::to_string(style));
    device().calibrated = true;
}
unsigned long hdScheduleAsynchronous(unsigned (*callback)(void*), void* user, unsigned short /*priority*/) {
    device().callback = callback;
    device().user = user;
    return 1;
}
void hdUnschedule(unsigned long /*scheduled*/) {}
void hdStartScheduler() {
    device().running = true;
    device().servo = std::thread([] { device().run(); });
}
void hdStopScheduler() {
    device().running = false;
    if (device().servo.joinable()) device().servo.join();
    device().say("stop");
}

}  // extern "C"
