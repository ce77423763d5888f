#include "master/devices/falcon/falcon_handle.hpp"

#include <bit>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "master/devices/falcon/falcon_guardian.hpp"
#include "master/devices/falcon/falcon_kinematics.hpp"

namespace thimble {
namespace {

constexpr const char* kHome =
    "pull the grip all the way out, then push it all the way in, until its light is green";

}  // namespace

FalconHandle::FalconHandle(const FalconSettings& settings, double force_limit_N, std::string name,
                           FalconMailbox& mailbox)
    : settings_(settings),
      name_(std::move(name)),
      not_homed_(name_ + ": not homed; " + kHome + ", and start the trial again"),
      mailbox_(&mailbox),
      axis_(settings.axis, force_limit_N) {
    mailbox_->command({});
}

FalconHandle::~FalconHandle() { mailbox_->command({}); }

std::string_view FalconHandle::fault() const {
    if (!fault_.empty()) return fault_;
    return mailbox_->latest().report.homed() ? std::string_view{} : not_homed_;
}

std::string FalconHandle::awaits() {
    if (fault_.empty() && mailbox_->lost()) fail_lost();
    const FalconMailbox::Latest latest = mailbox_->latest();
    if (!fault_.empty() || latest.report.homed()) return {};
    if (!latest.any) return name_ + ": no report yet";
    return fmt::format("{}: {} of 3 legs homed; {}", name_, std::popcount(latest.report.homed_legs), kHome);
}

HandleSample FalconHandle::read(SessionTime now) {
    const bool good = fault_.empty() && take_report(now);
    // A force that the exchange has withheld does not come back by itself: the next command counts.
    if (mailbox_->take_withheld()) force_hand_N_ = 0;
    if (good) {
        ++reads_;
        if (mailbox_->silent()) ++silent_reads_;
        apply();
    }
    return {axis_.position_hand_m(), good ? force_hand_N_ : 0, good};
}

bool FalconHandle::take_report(SessionTime now) {
    const FalconMailbox::Latest latest = mailbox_->latest();
    if (mailbox_->lost()) return fail_lost();
    if (!reading_ || latest.count != count_) heard_ = now;
    reading_ = true;
    count_ = latest.count;
    if (now - heard_ > kStalledAfter)
        return fail(fmt::format("no report for {} ms: it has stopped", kStalledAfter.count() / 1'000'000));
    if (!latest.report.homed()) {
        if (homed_) return fail("it no longer knows the position of its legs (power or firmware failed)");
        return false;
    }
    homed_ = true;
    FalconAngles angles_rad{};
    for (std::size_t leg = 0; leg < 3; ++leg)
        angles_rad[leg] = falcon_leg_angle_rad(latest.report.encoders[leg]);
    const auto position_m = falcon_position_m(angles_rad, position_m_);
    if (!position_m)
        return fail(fmt::format("impossible encoder counts {} {} {}", latest.report.encoders[0],
                                latest.report.encoders[1], latest.report.encoders[2]));
    position_m_ = *position_m;
    axis_.move_to(now, position_m_);
    return true;
}

void FalconHandle::command_force(SessionTime /*now*/, double force_hand_N) {
    const double wanted_N = forced_ && fault_.empty() ? axis_.clipped_N(force_hand_N) : 0;
    if (wanted_N == force_hand_N_) return;
    force_hand_N_ = wanted_N;
    apply();
}

// Also without force: each command shows that the handle's side is alive.
void FalconHandle::apply() {
    FalconMotors motors;
    if (forced_ && fault_.empty()) {
        const auto torques_Nm = falcon_leg_torques_Nm(position_m_, axis_.force_device_N(force_hand_N_));
        if (torques_Nm) motors = falcon_motors(*torques_Nm, settings_.motor_gain_per_Nm);
        if (motors.saturated) ++saturated_;
    }
    mailbox_->command(motors.counts);
}

void FalconHandle::enable_force(SessionTime now, bool enabled) {
    forced_ = false;
    force_hand_N_ = 0;
    reading_ = false;  // between trials it was not read
    if (enabled && fault_.empty() && take_report(now)) {
        axis_.hold_here();
        forced_ = true;
    }
    apply();
}

// The first fault counts, and no force comes back by itself.
bool FalconHandle::fail(const std::string& what) {
    forced_ = false;
    force_hand_N_ = 0;
    fault_ = fmt::format(
        "{}: {}; unplug it from power and USB, plug both in again, and start thimble-master again", name_,
        what);
    mailbox_->command({});
    return false;
}

bool FalconHandle::fail_lost() {
    const bool unplugged = mailbox_->loss() == FalconLoss::kUnplugged;
    return fail(unplugged ? "it was unplugged or switched off" : "its guardian process has ended");
}

bool FalconHandle::take_stop(SessionTime /*now*/) {
    return (mailbox_->take_buttons() & settings_.stop_buttons) != 0;
}

void FalconHandle::describe(nlohmann::ordered_json& report) const {
    nlohmann::ordered_json& own = report["handle"];
    own["device"] = name_;
    own["reads"] = reads_;
    own["reads_without_report"] = silent_reads_;
    own["saturated"] = saturated_;
    if (!fault_.empty()) own["fault"] = fault_;
}

namespace {

// The handle goes first, then the guardian with its last command.
class GuardedFalcon final : private FalconGuardian, public FalconHandle {
  public:
    GuardedFalcon(const FalconSettings& settings, double force_limit_N, const RuntimeSettings& runtime,
                  const std::string& program)
        : FalconGuardian(settings, runtime, program),
          FalconHandle(settings, force_limit_N, fmt::format("Novint Falcon, serial {}", serial()),
                       mailbox()) {}
};

}  // namespace

std::unique_ptr<Handle> open_falcon(const FalconSettings& settings, double force_limit_N,
                                    const RuntimeSettings& runtime, const std::string& program) {
    return std::make_unique<GuardedFalcon>(settings, force_limit_N, runtime, program);
}

}  // namespace thimble
