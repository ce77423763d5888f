#include "cutaneous_node/simulated_actuator.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

namespace thimble {
namespace {

// A lag never quite reaches zero; below this the cable counts as slack.
constexpr double kSlack_N = 1e-6;

// Twice the 1 kHz of the experiments; what comes faster is coalesced.
std::size_t ring_size(Duration dead_time) {
    const auto in_flight = static_cast<std::size_t>(dead_time / std::chrono::milliseconds{1});
    return std::bit_ceil(2 * in_flight + 8);
}

}  // namespace

SimulatedActuator::SimulatedActuator(const CutaneousSettings& settings)
    : dead_time_(settings.dead_time),
      time_constant_s_(to_seconds(settings.time_constant)),
      limit_N_(settings.force_limit_N),
      ring_(ring_size(settings.dead_time)) {
    assert(settings.dead_time >= Duration::zero() && settings.time_constant >= Duration::zero());
    assert(settings.force_limit_N > 0);
}

void SimulatedActuator::command(SessionTime now, Finger finger, double force_N) {
    take_due_targets(now);
    if (count_ == ring_.size()) {
        --count_;
        ++coalesced_;
    }
    // Written so that a NaN is no force.
    const bool pressed = finger != Finger::kNone && force_N > 0;
    waiting(count_++) = {now + dead_time_, now, pressed ? std::min(force_N, limit_N_) : 0.0, finger};
}

FingertipForce SimulatedActuator::output(SessionTime now) {
    take_due_targets(now);
    const Forces force = forces_at(now);
    const double strongest_N = std::max(force.index_N, force.thumb_N);
    if (strongest_N < kSlack_N) return {Finger::kNone, 0, target_.sample_time};
    const Finger finger = force.index_N >= force.thumb_N ? Finger::kIndex : Finger::kThumb;
    return {finger, strongest_N, target_.sample_time};
}

void SimulatedActuator::release(SessionTime now) {
    count_ = 0;
    target_ = {now, now, 0, Finger::kNone};
    start_ = {};
}

void SimulatedActuator::take_due_targets(SessionTime now) {
    while (count_ > 0 && waiting(0).due <= now) {
        start_ = forces_at(waiting(0).due);
        target_ = waiting(0);
        ++first_;
        --count_;
    }
}

// Exact, and always from the last change of target: asking more often does not change the answer.
SimulatedActuator::Forces SimulatedActuator::forces_at(SessionTime now) const {
    const Forces goal{target_.finger == Finger::kIndex ? target_.force_N : 0,
                      target_.finger == Finger::kThumb ? target_.force_N : 0};
    if (time_constant_s_ == 0) return goal;
    const double rest = std::exp(-to_seconds(now - target_.due) / time_constant_s_);
    return {goal.index_N + (start_.index_N - goal.index_N) * rest,
            goal.thumb_N + (start_.thumb_N - goal.thumb_N) * rest};
}

}  // namespace thimble
