#include "stability/hand_motion.hpp"

#include <algorithm>
#include <cmath>

namespace thimble {

void HandMotion::advance(const Propagator& propagator, double force_N) {
    if (friction_N_ > 0) {
        advance_rubbing(propagator, force_N);
    } else {
        slide(propagator, hand_.acceleration(force_N, position_m_, velocity_m_per_s_));
    }
}

void HandMotion::slide(const Propagator& propagator, double acceleration_m_per_s2) {
    const double moved_m = propagator.moved_m(velocity_m_per_s_, acceleration_m_per_s2);
    velocity_m_per_s_ = propagator.velocity_after_m_per_s(velocity_m_per_s_, acceleration_m_per_s2);
    position_m_ += moved_m;
}

void HandMotion::advance_rubbing(Propagator left, double force_N) {
    while (left.duration_s > 0) {
        const double drive_N = force_N - stiffness_N_per_m_ * position_m_;
        if (velocity_m_per_s_ == 0 && std::abs(drive_N) <= friction_N_) return;  // sticks
        const double way = std::copysign(1.0, velocity_m_per_s_ != 0 ? velocity_m_per_s_ : drive_N);
        const double acceleration =
            hand_.acceleration(force_N - way * friction_N_, position_m_, velocity_m_per_s_);
        if (velocity_m_per_s_ == 0 && way * acceleration <= 0) return;  // by the last digits
        const double turn = turn_s(way, acceleration, left);
        if (turn >= left.duration_s) {
            slide(left, acceleration);
            return;
        }
        slide(hand_.propagator(turn), acceleration);
        velocity_m_per_s_ = 0;
        left = hand_.propagator(left.duration_s - turn);
    }
}

// The velocity falls to zero before its next extreme if it is falling, else between its first two: one root in the bracket.
double HandMotion::turn_s(double way, double acceleration_m_per_s2, const Propagator& whole) const {
    const double v = velocity_m_per_s_;
    const Inflections extremes = hand_.inflections(v, acceleration_m_per_s2);
    const bool falling = way * acceleration_m_per_s2 <= 0;
    double low = falling ? 0 : extremes.first_s;
    double high = std::min(whole.duration_s, falling ? extremes.first_s : low + extremes.spacing_s);
    if (!(low < high)) return whole.duration_s;
    const auto speed = [&](const Propagator& p) {
        return way * p.velocity_after_m_per_s(v, acceleration_m_per_s2);
    };
    if (speed(high == whole.duration_s ? whole : hand_.propagator(high)) >= 0) return whole.duration_s;
    double t = low + (high - low) / 2;
    constexpr int kMost = 100;  // halvings alone end well before
    for (int i = 0; i < kMost && low < t && t < high; ++i) {
        const Propagator p = hand_.propagator(t);
        const double now = speed(p);
        (now > 0 ? low : high) = t;
        if (now == 0) break;
        // Newton where it stays inside, else the middle.
        const double next = t - now / (way * hand_.acceleration_after(p, v, acceleration_m_per_s2));
        t = low < next && next < high ? next : low + (high - low) / 2;
    }
    return t;
}

}  // namespace thimble
