#include "master/devices/touch/touch_handle.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

constexpr double kMillimetre_m = 0.001;
constexpr unsigned short kServoPriority = 0xffff;  // no other callback comes before ours
// After an error that passes.
constexpr int kFramesWithoutForce = 50;
constexpr Duration kErrorsLast = std::chrono::milliseconds{200};
constexpr Duration kLastCall = std::chrono::milliseconds{200};

}  // namespace

TouchDevice::TouchDevice(const TouchSettings& settings, double force_limit_N)
    : library_(settings.library), hd_(library_.call()), most_N_(force_limit_N), axis_(settings.axis.axis) {
    open(settings);
    hd_.enable(kHdForceOutput);
    scheduled_ = hd_.schedule(&TouchDevice::servo, this, kServoPriority);
    hd_.start_scheduler();
    if (const std::string error = library_.take_error(); !error.empty()) refuse(error);
}

TouchDevice::~TouchDevice() {
    ending_ = true;
    for (const SessionTime end = wall_now() + kLastCall; !ended_ && wall_now() < end;)
        wall_sleep(std::chrono::milliseconds{1});
    hd_.stop_scheduler();
    hd_.unschedule(scheduled_);
    hd_.make_current(device_);
    hd_.disable(kHdForceOutput);
    hd_.disable_device(device_);
}

void TouchDevice::open(const TouchSettings& settings) {
    device_ = hd_.init_device(settings.name.empty() ? nullptr : settings.name.c_str());
    const std::string error = library_.take_error();
    if (device_ == kHdNoDevice || !error.empty()) {
        throw Error(ExitCode::kUsage,
                    "{} cannot open {}: {}. Plug it in and switch it on, and run the maker's setup "
                    "program (Touch_Setup), which gives it a name",
                    library_.file(), settings.name.empty() ? "a device" : "device '" + settings.name + "'",
                    error.empty() ? "no reason is known" : error);
    }
    hd_.make_current(device_);
    const char* model = hd_.get_string(kHdModel);
    const char* serial = hd_.get_string(kHdSerial);
    name_ = fmt::format("{}, serial {}", model == nullptr ? "unknown device" : model,
                        serial == nullptr ? "unknown" : serial);
    double device_N = 0;
    hd_.get_doubles(kHdMostForce, &device_N);
    if (library_.take_error().empty() && device_N > 0) most_N_ = std::min(most_N_, device_N);
}

void TouchDevice::refuse(const std::string& why) {
    hd_.stop_scheduler();
    hd_.disable_device(device_);
    throw Error(ExitCode::kRunFailed, "{} does not start: {}", name_, why);
}

std::string TouchDevice::calibrate() {
    hd_.make_current(device_);
    const unsigned state = hd_.check_calibration();
    library_.take_error();
    if (state == kHdCalibrated) return "";
    if (state != kHdNeedsUpdate)
        return "not calibrated: put the stylus into its holder until the light is steady";
    int styles = 0;
    hd_.get_integers(kHdCalibrationStyle, &styles);
    const auto all = static_cast<unsigned>(styles);
    hd_.update_calibration(all & (~all + 1));  // its first style, of one bit
    library_.take_error();
    return "calibrating: put the stylus into its holder";
}

unsigned TouchDevice::servo(void* self) {
    auto& touch = *static_cast<TouchDevice*>(self);
    touch.exchange();
    return touch.ended_ ? kHdDone : kHdContinue;
}

// An error shows only after a force was set. The following calls set none.
void TouchDevice::exchange() {
    const bool ending = ending_;
    const SessionTime now = wall_now();
    hd_.begin_frame(device_);
    const DeviceVector position_m = read_position_m();
    int buttons = 0;
    hd_.get_integers(kHdButtons, &buttons);
    const bool sane = std::all_of(position_m.begin(), position_m.end(), [](double component_m) {
        return std::fabs(component_m) < DeviceMailbox::kReach_m;  // NaN fails this
    });
    push(mailbox_.carry(now, ending || !sane || warned_frames_ > 0 || !mailbox_.loss().empty()));
    hd_.end_frame(device_);
    judge(now);
    if (sane && mailbox_.loss().empty()) mailbox_.publish(position_m, static_cast<std::uint32_t>(buttons));
    if (ending) ended_ = true;
}

// An error that passes costs the force for some frames. Another one, or errors that last, cost the device.
void TouchDevice::judge(SessionTime now) {
    bool passes = false;
    const std::string error = library_.take_error(&passes);
    if (error.empty()) {
        warned_frames_ = std::max(warned_frames_ - 1, 0);
        return;
    }
    if (warned_frames_ == 0) warned_at_ = now;
    warned_frames_ = kFramesWithoutForce;
    if (!passes || now - warned_at_ > kErrorsLast)
        mailbox_.lose(error + "; is it plugged in and switched on, and are its motors cool?");
}

DeviceVector TouchDevice::read_position_m() {
    DeviceVector position{std::nan(""), std::nan(""), std::nan("")};
    hd_.get_doubles(kHdPosition, position.data());
    for (double& component : position) component *= kMillimetre_m;
    return position;
}

// Limits the force to what the device allows: the library reports more as an error. The lateral force gives way, because
// read() says what is applied along the axis.
void TouchDevice::push(const DeviceVector& force_N) {
    const double axial_N = std::clamp(force_N[axis_], -most_N_, most_N_);
    double lateral_squared = 0;
    for (std::size_t i = 0; i < 3; ++i) lateral_squared += i == axis_ ? 0.0 : force_N[i] * force_N[i];
    const double lateral_N = std::sqrt(lateral_squared),
                 room_N = std::sqrt((most_N_ - axial_N) * (most_N_ + axial_N));
    const double scale = lateral_N > room_N ? room_N / lateral_N : 1;
    DeviceVector cut_N{scale * force_N[0], scale * force_N[1], scale * force_N[2]};
    cut_N[axis_] = axial_N;
    hd_.set_doubles(kHdForce, cut_N.data());
}

namespace {

// The handle goes first, then the device with its last call.
class TouchHandle final : private TouchDevice, public MailboxHandle {
  public:
    TouchHandle(const TouchSettings& settings, double force_limit_N)
        : TouchDevice(settings, force_limit_N),
          MailboxHandle(settings.axis, most_N(),
                        settings.stop_button == 0 ? 0 : 1U << (settings.stop_button - 1), TouchDevice::name(),
                        mailbox()) {}

    std::string name() const override { return MailboxHandle::name(); }

  private:
    std::string next_step() override { return calibrate(); }
};

}  // namespace

std::unique_ptr<Handle> open_touch(const TouchSettings& settings, double force_limit_N) {
    return std::make_unique<TouchHandle>(settings, force_limit_N);
}

}  // namespace thimble
