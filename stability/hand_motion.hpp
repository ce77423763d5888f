// A held mass with dry friction, moved exactly under a force that stays the same for a while:
//
//     m x" + b x' + k x + f_c sgn(x') = f
//
// While x' keeps its sign that is a linear motion under f -+ f_c. Where x' comes to zero the mass sticks if |f - k x| <= f_c,
// else it turns or goes on; the root of x' is found to the last digits. SI units.
#pragma once

#include <algorithm>
#include <cmath>

#include "slave_sim/second_order.hpp"
#include "stability/critical_delay.hpp"

namespace thimble {

class HandMotion {
  public:
    HandMotion(const HeldMass& hand, double position_m, double velocity_m_per_s)
        : hand_(hand.mass_kg, hand.damping_Ns_per_m, hand.stiffness_N_per_m),
          stiffness_N_per_m_(hand.stiffness_N_per_m),
          position_m_(position_m),
          velocity_m_per_s_(velocity_m_per_s) {}

    // Sets f_c >= 0, N.
    void rub(double friction_N) { friction_N_ = friction_N; }
    Propagator propagator(double duration_s) const { return hand_.propagator(duration_s); }
    // Under the force f for the propagator's time.
    void advance(const Propagator& propagator, double force_N) {
        if (friction_N_ > 0) {
            advance_rubbing(propagator, force_N);
        } else {
            slide(propagator, hand_.acceleration(force_N, position_m_, velocity_m_per_s_));
        }
    }

    double position_m() const { return position_m_; }
    double velocity_m_per_s() const { return velocity_m_per_s_; }

  private:
    void slide(const Propagator& propagator, double acceleration_m_per_s2) {
        const double moved_m = propagator.moved_m(velocity_m_per_s_, acceleration_m_per_s2);
        velocity_m_per_s_ = propagator.velocity_after_m_per_s(velocity_m_per_s_, acceleration_m_per_s2);
        position_m_ += moved_m;
    }

    void advance_rubbing(Propagator left, double force_N) {
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

    // When x' of a motion that goes `way` (+1, -1) is zero next; the whole time if it is not within it.
    // The velocity falls to zero before its next extreme if it is falling, else between its first two: one root in the bracket.
    double turn_s(double way, double acceleration_m_per_s2, const Propagator& whole) const {
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

    SecondOrder hand_;
    double stiffness_N_per_m_;
    double friction_N_ = 0;
    double position_m_, velocity_m_per_s_;
};

}  // namespace thimble
