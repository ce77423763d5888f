#include "master/devices/force_dimension/force_dimension_handle.hpp"

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "master/devices/usb_presence.hpp"

namespace thimble {
namespace {

constexpr std::uint16_t kForceDimensionVendor = 0x1451;
constexpr unsigned char kWatchdogTicks = 255;  // 31.9 ms
constexpr int kControllerTypes[] = {0, 60, 81,
                                    82};  // none, Falcon (its own driver is ours), bare controllers

using StatusArray = std::array<int, kDhdStatusCount>;

const char* force_off_cause(int cause) {
    static constexpr std::array kCauses{"no cause is known",
                                        "its force button was pressed",
                                        "it was moved too fast",
                                        "its watchdog fired: this program called too rarely",
                                        "by software",
                                        "USB was disconnected",
                                        "its dead man's switch was released"};
    const auto index = static_cast<std::size_t>(cause);
    return index < kCauses.size() ? kCauses[index] : kCauses[0];
}

std::string force_dimension_advice() {
    return usb_advice(look_for_usb(kForceDimensionVendor, std::nullopt), "Force Dimension device",
                      "70-thimble-handles.rules");
}

constexpr const char* kOnceMore =
    "remove the cause and start thimble-master again: the force does not come back by itself";

}  // namespace

ForceDimensionHandle::ForceDimensionHandle(const ForceDimensionSettings& settings, double force_limit_N,
                                           DhdLibrary library)
    : settings_(settings),
      library_(std::move(library)),
      dhd_(library_.call()),
      axis_(settings.axis, force_limit_N),
      force_limit_N_(force_limit_N) {
    open(settings.serial);
    try {
        prepare();
    } catch (...) {
        dhd_.stop(id_);
        dhd_.close(id_);
        throw;
    }
}

ForceDimensionHandle::~ForceDimensionHandle() {
    dhd_.stop(id_);
    dhd_.close(id_);
}

std::string ForceDimensionHandle::last_error() const {
    const int code = dhd_.error_code();
    const char* text = dhd_.error_text(code);
    return fmt::format("{} (error {})", text == nullptr ? "no message" : text, code);
}

int ForceDimensionHandle::serial_of(int id) const {
    unsigned short serial = 0;
    return dhd_.serial_number(&serial, static_cast<char>(id)) < 0 ? 0 : serial;
}

// Opens one after the other, keeps the wanted one, and closes the others.
void ForceDimensionHandle::open(int wanted_serial) {
    const int count = dhd_.device_count();
    if (count <= 0) {
        throw Error(ExitCode::kUsage, "no Force Dimension handle found by {}: {}", library_.file(),
                    force_dimension_advice());
    }
    if (count > 1 && wanted_serial == 0) {
        throw Error(ExitCode::kUsage,
                    "{} Force Dimension devices are connected: name one in [handle.force_dimension] serial "
                    "(printed on its base)",
                    count);
    }
    std::vector<std::string> others;
    others.reserve(static_cast<std::size_t>(count));
    for (int index = 0; index < count; ++index) {
        const int id = dhd_.open_id(static_cast<char>(index));
        if (id < 0) {
            others.push_back(fmt::format("number {} could not be opened: {}", index, last_error()));
            continue;
        }
        const int serial = serial_of(id);
        if (wanted_serial == 0 || serial == wanted_serial) {
            id_ = static_cast<char>(id);
            return;
        }
        others.push_back(fmt::format("number {} has serial {}", index, serial));
        dhd_.close(static_cast<char>(id));
    }
    throw Error(ExitCode::kUsage, "cannot open the Force Dimension handle{}: {}. {}",
                wanted_serial == 0 ? "" : fmt::format(" with serial {}", wanted_serial),
                fmt::join(others, "; "), force_dimension_advice());
}

void ForceDimensionHandle::prepare() {
    const int type = dhd_.system_type(id_);
    const char* type_name = dhd_.system_name(id_);
    name_ = fmt::format("{}, serial {}, SDK {}", type_name == nullptr ? "unknown device" : type_name,
                        serial_of(id_), library_.version());
    for (const int unfit : kControllerTypes) {
        if (type != unfit) continue;
        throw Error(ExitCode::kUsage,
                    "{} (type {}) is not a handle for device = \"force-dimension\": use device = \"falcon\" "
                    "for a Falcon; a controller alone has no arm",
                    name_, type);
    }
    if (settings_.stop_button >= 0 &&
        (dhd_.button == nullptr || dhd_.button(settings_.stop_button, id_) < 0)) {
        throw Error(ExitCode::kUsage,
                    "[handle.force_dimension] stop_button names button {1}, which {0} does not have", name_,
                    settings_.stop_button);
    }
    StatusArray status{};
    if (dhd_.status(status.data(), id_) < 0)
        throw Error(ExitCode::kRunFailed, "{} does not report its state: {}", name_, last_error());
    if (const std::string trouble = describe_status(status.data()); !trouble.empty())
        throw Error(ExitCode::kRunFailed, "{}: {}", name_, trouble);
    const auto demand = [&](int answer, const char* what) {
        if (answer >= 0) return;
        throw Error(ExitCode::kRunFailed, "{} rejects {}: {}", name_, what, last_error());
    };
    const AxisSettings& axis = settings_.axis;
    const double lateral_N = axis.lateral == LateralHold::kVirtual ? axis.lateral_force_limit_N : 0;
    demand(dhd_.set_max_force(force_limit_N_ + lateral_N, id_), "a force limit");
    demand(dhd_.set_gravity_compensation(settings_.gravity_compensation ? 1 : 0, id_),
           "gravity compensation");
    demand(dhd_.set_brakes(0, id_), "releasing its brakes");
    if (!settings_.watchdog) return;
    const bool set = dhd_.enable_expert_mode != nullptr && dhd_.set_watchdog != nullptr &&
                     dhd_.enable_expert_mode() >= 0 && dhd_.set_watchdog(kWatchdogTicks, id_) >= 0;
    if (dhd_.disable_expert_mode != nullptr) dhd_.disable_expert_mode();
    if (!set) {
        throw Error(ExitCode::kRunFailed,
                    "cannot set a watchdog in {} ({}): with [handle.force_dimension] watchdog = false it "
                    "keeps its last force if this program hangs",
                    name_, last_error());
    }
}

// Empty if all is well.
std::string ForceDimensionHandle::describe_status(const int* status) const {
    if (status[kDhdPower] == 0) return "it has no power: switch it on";
    if (status[kDhdConnected] == 0) return "it is not connected: plug in its USB cable";
    if (status[kDhdReset] != 0)
        return "it is not calibrated: hold the handle in its rest position until the light is steady, or run "
               "the SDK's autoinit";
    if (status[kDhdError] != 0)
        return "its controller reports an error: switch it off and on, and run the SDK's test program";
    if (forced_ && status[kDhdForce] == 0)
        return fmt::format("it has switched its motors off ({}): press its force button or let it rest",
                           force_off_cause(status[kDhdForceOffCause]));
    return "";
}

HandleSample ForceDimensionHandle::read(SessionTime now) {
    if (fault_.empty() && take_position(now)) {
        ++reads_;
        compare_velocities(now);
        if (--reads_until_status_ == 0) watch_status();
        if (forced_ && fault_.empty()) apply();
    }
    return {axis_.position_hand_m(), fault_.empty() && !held_ ? force_hand_N_ : 0, fault_.empty()};
}

bool ForceDimensionHandle::take_position(SessionTime now) {
    DeviceVector position_m{};
    const int answer = dhd_.position(&position_m[0], &position_m[1], &position_m[2], id_);
    if (answer < 0) {
        fail_in("dhdGetPosition");
        return false;
    }
    for (const double component_m : position_m) {
        if (std::fabs(component_m) < 1) continue;  // NaN fails this
        fail(fmt::format("dhdGetPosition gave the impossible position {} m", component_m), "calibrate it");
        return false;
    }
    if (answer != kDhdTimeGuard || !heard_) fresh_ = now;
    heard_ = true;
    if (now - fresh_ > kStalledAfter) {
        fail(fmt::format("no new position for {} ms: its clock has stopped",
                         kStalledAfter.count() / 1'000'000),
             "switch it off and on");
        return false;
    }
    held_ = now - fresh_ > kHeldAfter;
    if (held_) ++held_reads_;
    axis_.move_to(now, position_m);
    return true;
}

void ForceDimensionHandle::compare_velocities(SessionTime now) {
    const double ours_m_per_s = velocity_.update(now, axis_.position_hand_m()).velocity_m_per_s;
    DeviceVector theirs_m_per_s{};
    if (dhd_.linear_velocity(&theirs_m_per_s[0], &theirs_m_per_s[1], &theirs_m_per_s[2], id_) < 0)
        return;  // too early
    const double difference_m_per_s = axis_.along(theirs_m_per_s) - ours_m_per_s;
    if (!std::isfinite(difference_m_per_s)) return;
    squared_difference_ += difference_m_per_s * difference_m_per_s;
    ++compared_;
}

double ForceDimensionHandle::velocity_difference_m_per_s() const {
    return compared_ == 0 ? 0 : std::sqrt(squared_difference_ / static_cast<double>(compared_));
}

void ForceDimensionHandle::watch_status() {
    reads_until_status_ = kReadsPerStatus;
    StatusArray status{};
    if (dhd_.status(status.data(), id_) < 0) return fail_in("dhdGetStatus");
    if (const std::string trouble = describe_status(status.data()); !trouble.empty()) fail(trouble, "");
}

void ForceDimensionHandle::command_force(SessionTime /*now*/, double force_hand_N) {
    const double wanted_N = forced_ && fault_.empty() ? axis_.clipped_N(force_hand_N) : 0;
    if (wanted_N == force_hand_N_) return;
    force_hand_N_ = wanted_N;
    if (forced_ && fault_.empty()) apply();
}

void ForceDimensionHandle::apply() {
    const DeviceVector force_N = held_ ? DeviceVector{} : axis_.force_device_N(force_hand_N_);
    const int answer = dhd_.set_force(force_N[0], force_N[1], force_N[2], id_);
    if (answer < 0) return fail_in("dhdSetForce");
    if (answer == kDhdMotorSaturated) ++saturated_;
}

void ForceDimensionHandle::enable_force(SessionTime now, bool enabled) {
    force_hand_N_ = 0;
    heard_ = false;
    if (!enabled || !fault_.empty()) {
        const bool had_force = std::exchange(forced_, false);
        if (!had_force || !fault_.empty()) return;
        // Idle: positions can be read, no current flows.
        if (dhd_.set_force(0, 0, 0, id_) < 0 || dhd_.enable_force(0, id_) < 0 || dhd_.set_brakes(0, id_) < 0)
            fail_in("switching its motors off");
        return;
    }
    if (!take_position(now)) return;
    axis_.hold_here();
    if (dhd_.enable_force(1, id_) < 0) return fail_in("dhdEnableForce");
    forced_ = true;
    apply();
}

bool ForceDimensionHandle::take_stop(SessionTime now) {
    looked_ = now;
    return settings_.stop_button >= 0 && dhd_.button(settings_.stop_button, id_) > 0;
}

void ForceDimensionHandle::fail_in(const char* function) {
    fail(fmt::format("{} failed: {}", function, last_error()), "is it still plugged in and switched on?");
}

// Keeps the first fault; later ones follow from it.
void ForceDimensionHandle::fail(const std::string& what, const std::string& remedy) {
    if (!fault_.empty()) return;
    forced_ = false;
    force_hand_N_ = 0;
    dhd_.set_force(0, 0, 0, id_);
    dhd_.stop(id_);
    fault_ = fmt::format("{}: {}{}{}; {}", name_, what, remedy.empty() ? "" : "; ", remedy, kOnceMore);
}

void ForceDimensionHandle::describe(nlohmann::ordered_json& report) const {
    nlohmann::ordered_json& own = report["handle"];
    own["device"] = name_;
    own["library"] = library_.file();
    own["reads"] = reads_;
    own["reads_without_position"] = held_reads_;
    own["saturated"] = saturated_;
    own["velocity_difference_m_per_s"] = velocity_difference_m_per_s();
    if (!fault_.empty()) own["fault"] = fault_;
}

}  // namespace thimble
