// A libdhd.so.3 of our own with a scripted device behind it, which the real dlopen finds. The environment variable
// THIMBLE_FAKE_DHD names its script: lines "key value", read when a caller asks how many devices there are. Keys
// ending in _after count calls of dhdGetPosition; positions in metres. The hand goes in by `press` metres
// within 1000 of these calls and out within 1000 more, over and over. If the script names a file `back`, it
// goes in and out once, and stays in until that file exists. A button is down while the file `button_file`
// names exists. It writes what it was told to the file `log` names.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <string>

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr long kWay_reads = 1000;
constexpr int kTimeGuard = 1, kSaturated = 2;
constexpr int kErrorCommunication = 2, kErrorInUse = 20, kErrorNotImplemented = 10;

struct Device {
    std::map<std::string, std::string> script;
    long positions = 0;
    long moves = 0;  // of the hand, at most one with each position
    int error = 0, opened = -1;
    bool forced = false;
    std::string last_force;

    void read_script() {
        script.clear();
        positions = moves = 0;
        error = 0;
        opened = -1;
        forced = false;
        last_force.clear();
        const char* path = std::getenv("THIMBLE_FAKE_DHD");
        std::ifstream file(path == nullptr ? "" : path);
        std::string key, value;
        while (file >> key && std::getline(file >> std::ws, value)) script[key] = value;
    }
    double number(const char* key, double fallback) const {
        const auto found = script.find(key);
        return found == script.end() ? fallback : std::strtod(found->second.c_str(), nullptr);
    }
    bool after(const char* key) const {
        return static_cast<double>(positions) > number(key, std::numeric_limits<double>::infinity());
    }
    void say(const std::string& line) const {
        const auto found = script.find("log");
        if (found == script.end()) return;
        std::ofstream(found->second, std::ios::app) << line << '\n';
    }
    int fail(int code) {
        error = code;
        return -1;
    }
    bool gone() const { return after("unplugged_after"); }
    bool there(const char* key) const {
        const auto file = script.find(key);
        return file != script.end() && std::ifstream(file->second).good();
    }
    void move() {
        const bool waits = moves == kWay_reads && !there("back"), is_out = moves == 2 * kWay_reads;
        if (script.count("back") == 0 || (!waits && !is_out)) ++moves;
    }
    double turn() const { return kPi * static_cast<double>(moves) / kWay_reads; }
};

Device& device() {
    static Device one;
    return one;
}

}  // namespace

extern "C" {

int dhdGetDeviceCount() {
    device().read_script();
    return static_cast<int>(device().number("devices", 1));
}
int dhdOpenID(char index) {
    if (device().number("in_use", 0) != 0) return device().fail(kErrorInUse);
    device().opened = index;
    return index;
}
int dhdClose(char /*id*/) {
    device().say("close");
    return 0;
}
int dhdStop(char /*id*/) {
    device().say("stop");
    device().forced = false;
    return device().gone() ? device().fail(kErrorCommunication) : 0;
}
int dhdGetSystemType(char /*id*/) { return static_cast<int>(device().number("type", 33)); }
const char* dhdGetSystemName(char /*id*/) { return "omega.3"; }
int dhdGetSerialNumber(unsigned short* serial, char id) {
    *serial = static_cast<unsigned short>(device().number("serial", 1001) + id);
    return 0;
}
void dhdGetSDKVersion(int* major, int* minor, int* release, int* revision) {
    *major = 3;
    *minor = 17;
    *release = *revision = 0;
}
int dhdGetPosition(double* x, double* y, double* z, char /*id*/) {
    Device& d = device();
    ++d.positions;
    d.move();
    if (d.gone()) return d.fail(kErrorCommunication);
    *x = d.number("x", 0) - d.number("press", 0) * (1 - std::cos(d.turn())) / 2;
    *y = d.number("y", 0);
    *z = d.number("z", 0);
    if (d.after("garbled_after")) *y = std::numeric_limits<double>::quiet_NaN();
    if (d.after("moved_after")) *y += 0.001;
    return d.after("stalled_after") ? kTimeGuard : 0;
}
int dhdGetLinearVelocity(double* x, double* y, double* z, char /*id*/) {
    *x = -device().number("press", 0) * std::sin(device().turn()) / 2 * 2 * kPi / 2;
    *y = *z = 0;
    return device().gone() ? -1 : 0;
}
int dhdSetForce(double x, double y, double z, char /*id*/) {
    Device& d = device();
    if (d.gone()) return d.fail(kErrorCommunication);
    char line[100];
    std::snprintf(line, sizeof line, "force %.3f %.3f %.3f", x + 0.0, y + 0.0, z + 0.0);
    if (line != d.last_force) d.say(d.last_force = line);
    return d.after("saturated_after") ? kSaturated : 0;
}
int dhdEnableForce(unsigned char on, char /*id*/) {
    device().forced = on != 0;
    device().say(on != 0 ? "enable 1" : "enable 0");
    return 0;
}
int dhdSetBrakes(int on, char /*id*/) {
    device().say("brakes " + std::to_string(on));
    return 0;
}
int dhdSetGravityCompensation(int on, char /*id*/) {
    device().say("gravity " + std::to_string(on));
    return 0;
}
int dhdSetMaxForce(double force_N, char /*id*/) {
    device().say("max " + std::to_string(force_N));
    return 0;
}
int dhdGetStatus(int* status, char /*id*/) {
    const Device& d = device();
    std::fill(status, status + 17, 0);
    status[0] = d.number("power", 1) != 0 ? 1 : 0;
    status[1] = 1;
    status[3] = d.after("uncalibrated_after") || d.number("uncalibrated", 0) != 0 ? 1 : 0;
    status[5] = d.forced && !d.after("motors_off_after") ? 1 : 0;
    status[14] = 3;
    return 0;
}
int dhdErrorGetLast() { return device().error; }
const char* dhdErrorGetStr(int code) {
    return code == kErrorInUse           ? "device already in use"
           : code == kErrorCommunication ? "communication error"
                                         : "error";
}
int dhdGetButton(int index, char /*id*/) {
    const Device& d = device();
    if (index >= d.number("buttons", 1)) return -1;
    return d.there("button_file") || d.after("pressed_after") ? 1 : 0;
}
int dhdEnableExpertMode() { return 0; }
int dhdDisableExpertMode() { return 0; }
int dhdSetWatchdog(unsigned char ticks, char /*id*/) {
    if (device().number("no_watchdog", 0) != 0) return device().fail(kErrorNotImplemented);
    device().say("watchdog " + std::to_string(ticks));
    return 0;
}

}  // extern "C"
