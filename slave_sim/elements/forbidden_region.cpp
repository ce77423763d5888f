#include "slave_sim/elements/forbidden_region.hpp"

#include <algorithm>
#include <limits>

namespace thimble {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

ForbiddenRegion::ForbiddenRegion(const FixtureParameters& parameters)
    : parameters_(parameters), placed_{parameters.position_m, true}, now_(placed_) {}

void ForbiddenRegion::place(double position_m, bool present, double position_needle_m) {
    placed_ = now_ = {position_m, present};
    force_N_ = touch(position_needle_m).force_N;
}

FixtureContact ForbiddenRegion::touch(double position_needle_m, double velocity_m_per_s) const {
    if (!beyond(position_needle_m)) return {position_needle_m, 0, 0};
    const double penetration_m = position_needle_m - now_.position_m;
    const double push_N =
        parameters_.stiffness_N_per_m * penetration_m + parameters_.damping_Ns_per_m * velocity_m_per_s;
    return {now_.position_m, penetration_m, -std::max(0.0, push_N)};
}

void ForbiddenRegion::reset(double position_needle_m) {
    now_ = placed_;
    next_change_ = 0;
    touching_ = false;  // a needle that starts beyond the plane touches it as the first step begins
    force_N_ = touch(position_needle_m).force_N;
}

void ForbiddenRegion::step(const NeedleStep& step, Transitions& transitions) {
    for (double offset_s = 0;;) {
        const double flip_s = flip_offset_s(step, offset_s);
        const double change_s = change_offset_s(step, offset_s);
        offset_s = std::min(flip_s, change_s);
        if (offset_s == kInfinity) break;
        if (flip_s <= change_s) {
            flip(step, offset_s, transitions);
        } else {
            apply(parameters_.changes[next_change_++], offset_s, transitions);
        }
    }
    force_N_ = touch(step.to_m, step.velocity_m_per_s).force_N;
}

// When contact begins or ends: at once if the plane was moved past the needle, else where the line crosses it.
double ForbiddenRegion::flip_offset_s(const NeedleStep& step, double from_s) const {
    const double travel_m = step.to_m - step.from_m;
    if (!now_.present || travel_m == 0) return beyond(step.to_m) == touching_ ? kInfinity : from_s;
    const bool inwards = travel_m > 0;
    // Rounding keeps the order of plane and needle's end, so this is within the step if the needle crosses.
    const double cross_s = (now_.position_m - step.from_m) / travel_m * step.duration_s;
    const bool beyond_now = inwards ? cross_s <= from_s : cross_s > from_s;
    if (beyond_now != touching_) return from_s;
    return inwards != touching_ && beyond(step.to_m) == inwards ? cross_s : kInfinity;
}

// A change that falls on the end of the step belongs to the next one: what is reported is a left limit.
double ForbiddenRegion::change_offset_s(const NeedleStep& step, double from_s) const {
    if (next_change_ == parameters_.changes.size()) return kInfinity;
    const FixtureChange& change = parameters_.changes[next_change_];
    double due_s = kInfinity;
    if (change.time_s) due_s = *change.time_s;
    if (change.after_contact_s && touching_) due_s = touching_since_s_ + *change.after_contact_s;
    const double offset_s = std::max(due_s - step.start_s, from_s);
    return offset_s < step.duration_s ? offset_s : kInfinity;
}

void ForbiddenRegion::flip(const NeedleStep& step, double offset_s, Transitions& transitions) {
    touching_ = !touching_;
    touching_since_s_ = step.start_s + offset_s;
    transitions.push(offset_s, touching_ ? "touched" : "left");
}

void ForbiddenRegion::apply(const FixtureChange& change, double offset_s, Transitions& transitions) {
    transitions.push(offset_s, !change.present ? "removed" : now_.present ? "moved" : "placed");
    now_ = {change.position_m.value_or(now_.position_m), change.present};
}

// A change at a time of its own comes whether or not the needle is near.
double ForbiddenRegion::rests_above_m() const {
    const bool timed =
        next_change_ < parameters_.changes.size() && parameters_.changes[next_change_].time_s.has_value();
    if (timed || touching_) return -kInfinity;
    return now_.present ? now_.position_m : kInfinity;
}

}  // namespace thimble
