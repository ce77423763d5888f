// Exact motion of  M x'' + B x' + K x = f  with constant f: mass, damper and spring for any time at once.
//
// Increment form, with a = B/M, w2 = K/M and a0 = x''(0):
//     x(t) = x(0) + P v(0) + Q a0        v(t) = c v(0) + S a0
// S is the response of the velocity to a unit step of acceleration, Q its integral, P = S + a Q, c = 1 - w2
// Q. No term divides by K, so a soft spring costs no digits, and nothing overflows when B t / M is huge.
#pragma once

namespace thimble {

// c, S, P and Q for one duration; computed once for a fixed step, anew for every trial time of an event.
struct Propagator {
    double duration_s = 0;
    double velocity_per_velocity = 1;         // c
    double velocity_per_acceleration_s = 0;   // S
    double position_per_velocity_s = 0;       // P
    double position_per_acceleration_s2 = 0;  // Q

    // x(t) - x(0) and v(t), from v(0) and x''(0).
    double moved_m(double velocity_m_per_s, double acceleration_m_per_s2) const {
        return position_per_velocity_s * velocity_m_per_s +
               position_per_acceleration_s2 * acceleration_m_per_s2;
    }
    double velocity_after_m_per_s(double velocity_m_per_s, double acceleration_m_per_s2) const {
        return velocity_per_velocity * velocity_m_per_s + velocity_per_acceleration_s * acceleration_m_per_s2;
    }
};

// Where x''(t), a damped exponential or sinusoid, is zero: at first_s, then every spacing_s. Infinite if
// never.
struct Inflections {
    double first_s;
    double spacing_s;
};

// Position since t = 0 stays within center +- amplitude e^(-fade t).
struct Swing {
    double center_m;
    double amplitude_m;
    double fade_per_s;
};

class SecondOrder {
  public:
    // mass > 0; damping and stiffness >= 0 (asserted).
    SecondOrder(double mass_kg, double damping_Ns_per_m, double stiffness_N_per_m);

    // duration >= 0 (asserted, so that NaN is refused too). Zero gives the identity.
    Propagator propagator(double duration_s) const;

    // x'' under the force f.
    double acceleration(double force_N, double position_m, double velocity_m_per_s) const {
        return (force_N - damping_Ns_per_m_ * velocity_m_per_s - stiffness_N_per_m_ * position_m) * per_mass_;
    }

    // x''(t) from v(0) and x''(0).
    double acceleration_after(const Propagator& p, double velocity_m_per_s,
                              double acceleration_m_per_s2) const {
        return acceleration_m_per_s2 *
                   (p.velocity_per_velocity - damping_per_s_ * p.velocity_per_acceleration_s) -
               stiffness_per_s2_ * p.velocity_per_acceleration_s * velocity_m_per_s;
    }

    // The zeros of x''(t) at t > 0.
    Inflections inflections(double velocity_m_per_s, double acceleration_m_per_s2) const;

    // Of a motion whose inflections come again and again; meaningless otherwise.
    Swing swing(double velocity_m_per_s, double acceleration_m_per_s2) const;

    // No |x''(t)|, t >= 0, exceeds this: y = x' obeys the homogeneous equation, whose energy y'^2 + w2 y^2
    // only falls.
    double acceleration_bound(double velocity_m_per_s, double acceleration_m_per_s2) const {
        return magnitude(acceleration_m_per_s2) + natural_per_s_ * magnitude(velocity_m_per_s);
    }

    double stiffness_per_s2() const { return stiffness_per_s2_; }  // w2 = K / M
    double damping_per_s() const { return damping_per_s_; }        // a = B / M

  private:
    struct Response;  // S, Q, c

    static double magnitude(double value) { return value < 0 ? -value : value; }
    Response overdamped(double duration_s) const;
    Response underdamped(double duration_s) const;

    double damping_Ns_per_m_;
    double stiffness_N_per_m_;
    double per_mass_;
    double damping_per_s_;     // a
    double stiffness_per_s2_;  // w2
    double natural_per_s_;     // sqrt(w2)
    double half_damping_per_s_;
    bool oscillates_;
    double root_per_s_;  // sqrt|a^2/4 - w2|: frequency, or half the distance of the two real rates
    double slow_per_s_;  // the slower of two real decay rates
};

}  // namespace thimble
