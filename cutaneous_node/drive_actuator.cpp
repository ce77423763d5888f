#include "cutaneous_node/drive_actuator.hpp"

#include <algorithm>
#include <cmath>

namespace thimble {
namespace {

// A cable is taut when its motor has come to rest under pretension.
constexpr Duration kRestTime = std::chrono::milliseconds{100};
constexpr double kAtRest_m = 1e-4;
// Faster, the motor swings past pretension before its torque shows it, and nothing pays the cable out again.
constexpr double kDrawInSpeed_m_per_s = 0.0025;
// A pad that is let go needs up to 30 ms, and a busy machine may stretch them.
constexpr double kSlackFor_s = 0.1;

}  // namespace

DriveActuator::DriveActuator(const DriveSettings& settings, double force_limit_N, CanBus& bus)
    : settings_(settings),
      shape_{settings.deadband_N, force_limit_N},
      geometry_(settings.cable_angle_rad),
      pad_(settings.pad),
      master_(settings.master, bus) {
    cables_.assign(settings.master.nodes.size(),
                   Cable{0, 0, 0, false, SlackDetector(settings.slack_margin_m, kSlackFor_s), {}});
    for (const double relaxing : settings.pad.shares) relaxed_share_ -= relaxing;
    resting_m_ = pad_.indentation_m(settings.resting_N() / relaxed_share_);
    fault_.reserve(std::tuple_size_v<decltype(DeviceFault::text)>);
}

void DriveActuator::command(SessionTime now, Finger finger, double force_N) {
    finger_ = finger;
    force_N_ = finger == Finger::kNone ? 0 : shape_.shaped_N(force_N);
    if (force_N_ > 0 && !settings_.worn(hand_, finger))
        fail(now, DriveFaultKind::kNoDevice, settings_.master.nodes.size());
}

void DriveActuator::release(SessionTime /*now*/) {
    finger_ = Finger::kNone;
    force_N_ = 0;
}

void DriveActuator::use_hand(SessionTime now, Hand hand) {
    hand_ = hand;
    release(now);
}

double DriveActuator::rated_torque_Nm(std::size_t drive) const {
    return master_.drive(drive).rated_torque() * settings_.rated_torque_unit_Nm;
}

double DriveActuator::tension_N(std::size_t drive) const {
    return settings_.cable.tension_N(master_.drive(drive).feedback().torque_per_mille,
                                     rated_torque_Nm(drive));
}

double DriveActuator::wound_m(std::size_t drive) const {
    return settings_.cable.wound_m(master_.drive(drive).feedback().position_counts, cables_[drive].origin);
}

double DriveActuator::drawn_in_m(double tension_N, double share) const {
    const double resting_N = settings_.resting_N();
    const double beyond_N = geometry_.normal_N({tension_N, tension_N, tension_N}) - resting_N;
    const double pressed_m = pad_.indentation_m(resting_N / relaxed_share_ + beyond_N / share) - resting_m_;
    return geometry_.wound_m(std::max(pressed_m, 0.0));
}

double DriveActuator::measured_N(std::size_t finger) const {
    const std::size_t first = settings_.fingers[finger].first;
    return geometry_.normal_N({tension_N(first), tension_N(first + 1), tension_N(first + 2)});
}

FingertipForce DriveActuator::output(SessionTime now) {
    FingertipForce felt{Finger::kNone, 0, now};
    const double resting_N = settings_.resting_N();
    for (std::size_t i = 0; ready() && i < settings_.fingers.size(); ++i) {
        const FingerDevice& finger = settings_.fingers[i];
        if (finger.hand != hand_) continue;
        const double force_N = measured_N(i) - resting_N;
        if (force_N < std::max(settings_.deadband_N, felt.force_N)) continue;
        felt = {finger.finger, force_N, now};
        for (std::size_t drive = finger.first; drive < finger.first + kCablesPerFinger; ++drive) {
            felt.sample_time = std::min(felt.sample_time, master_.drive(drive).feedback().sample_time);
        }
    }
    return felt;
}

void DriveActuator::set_tension(std::size_t drive, double tension_N) {
    if (settings_.master.mode == DriveMode::kSyncPosition) {
        // Of the first moment. The pad relaxes, so a held position presses less.
        master_.set_target(drive, settings_.cable.counts(drawn_in_m(tension_N, 1), cables_[drive].origin));
    } else {
        master_.set_target(drive, settings_.cable.torque_per_mille(tension_N, rated_torque_Nm(drive)));
    }
}

// While one motor of a finger gives no position, all of its cables stay at pretension.
void DriveActuator::set_targets() {
    const bool known = !master_.unanswered();
    for (const FingerDevice& device : settings_.fingers) {
        const bool pressed = known && device.hand == hand_ && device.finger == finger_;
        const double tension_N = geometry_.tension_N(pressed ? force_N_ : 0) + settings_.pretension_N;
        for (std::size_t i = 0; i < kCablesPerFinger; ++i) set_tension(device.first + i, tension_N);
    }
}

// By torque every cable draws itself in; by position it is drawn in until its torque shows pretension.
void DriveActuator::take_up(SessionTime now) {
    if (!taking_up_) {
        taking_up_ = true;
        taking_up_since_ = before_ = now;
        next_look_ = now + kRestTime;
        for (std::size_t i = 0; i < cables_.size(); ++i) {
            cables_[i].origin = master_.drive(i).feedback().position_counts;
        }
    }
    const bool position = settings_.master.mode == DriveMode::kSyncPosition;
    if (position) {
        draw_in(to_seconds(std::min(now - before_, 2 * settings_.master.cycle)));  // no jump after a stall
    } else {
        for (std::size_t i = 0; i < cables_.size(); ++i) set_tension(i, settings_.pretension_N);
    }
    before_ = now;
    if (!look_for_rest(now)) return;
    taut_ = true;
    for (std::size_t i = 0; i < cables_.size(); ++i) {
        cables_[i].origin = master_.drive(i).feedback().position_counts;
        cables_[i].measured = master_.drive(i).feedback().sample_time;
    }
}

void DriveActuator::draw_in(double step_s) {
    for (std::size_t i = 0; i < cables_.size(); ++i) {
        Cable& cable = cables_[i];
        if (tension_N(i) < settings_.pretension_N) cable.drawn_m += kDrawInSpeed_m_per_s * step_s;
        master_.set_target(i, settings_.cable.counts(cable.drawn_m, cable.origin));
    }
}

bool DriveActuator::look_for_rest(SessionTime now) {
    if (now < next_look_) return false;
    next_look_ = now + kRestTime;
    const Cable* loose = nullptr;
    for (std::size_t i = 0; i < cables_.size(); ++i) {
        Cable& cable = cables_[i];
        const double stands_m = wound_m(i);
        cable.taut =
            std::abs(stands_m - cable.before_m) < kAtRest_m && tension_N(i) > settings_.pretension_N / 2;
        cable.before_m = stands_m;
        if (!cable.taut && loose == nullptr) loose = &cable;
    }
    if (loose != nullptr && now - taking_up_since_ > settings_.take_up_limit) {
        fail(now, DriveFaultKind::kNoTakeUp, static_cast<std::size_t>(loose - cables_.data()));
    }
    return loose == nullptr;
}

// Only measured time counts: after a stall one sample of a loosened cable is no slack cable.
void DriveActuator::watch_slack(SessionTime now) {
    for (std::size_t i = 0; i < cables_.size(); ++i) {
        Cable& cable = cables_[i];
        const SessionTime measured = master_.drive(i).feedback().sample_time;
        if (measured <= cable.measured) continue;
        const Duration step = std::min(measured - cable.measured, 2 * settings_.master.cycle);
        cable.measured = measured;
        const double explained_m = drawn_in_m(tension_N(i), relaxed_share_);
        if (cable.slack.slack(wound_m(i), explained_m, to_seconds(step)))
            return fail(now, DriveFaultKind::kSlack, i);
    }
}

void DriveActuator::tick(SessionTime now) {
    if (master_.operating()) {
        if (taut_) {
            set_targets();
        } else {
            take_up(now);
        }
    }
    master_.tick(now);
    if (taut_ && master_.operating()) watch_slack(now);
    note_fault();
}

void DriveActuator::fail(SessionTime now, DriveFaultKind kind, std::size_t drive) {
    master_.fail(now, {kind, drive, "", 0});
}

void DriveActuator::note_fault() {
    const auto& fault = master_.fault();
    if (fault && fault_.empty()) {
        fault_ = describe(*fault, drive_name(settings_, fault->drive), settings_.bus);
    }
}

}  // namespace thimble
