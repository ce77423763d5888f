// The sampled loop as it runs: hand and held force stepped exactly, so that what is measured is the loop and not a solver.
//
// The position p beyond the wall is sampled at k h; the force K p (one-sided, limited, of an encoder's steps if asked for) reaches
// the hand T later and is held for h. Every place where the force changes is known in advance: at most two exact steps per sample
// (slave_sim/second_order.hpp), and more with dry friction where the hand turns. Without the non-linear parts it is the loop of
// sampled_loop.hpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "common/error.hpp"
#include "stability/circle_count.hpp"
#include "stability/hand_motion.hpp"
#include "stability/sampled_loop.hpp"

namespace thimble {

struct LoopConditions {
    SampledLoop loop;
    bool one_sided = false;     // a wall only pushes out
    double force_limit_N = 0;   // 0: none
    double encoder_step_m = 0;  // 0: exact; else p is rounded to the nearest step
    double press_N = 0;         // F_0: with which the hand would press at the wall
    double friction_N = 0;      // f_c, dry, of the handle
};

inline const HeldMass& checked_hand(const LoopConditions& conditions) {
    whole_steps(conditions.loop);  // throws where it is no loop
    if (conditions.friction_N >= 0 && std::isfinite(conditions.friction_N)) return conditions.loop.hand;
    throw Error(ExitCode::kUsage, "stability: friction must be finite and 0 N or more");
}

class LoopSimulator {
  public:
    // Starts with no force on its way. Throws Error (usage) as sampled_loop.hpp does.
    LoopSimulator(const LoopConditions& conditions, double position_m, double velocity_m_per_s)
        : conditions_(conditions), hand_(checked_hand(conditions), position_m, velocity_m_per_s) {
        hand_.rub(conditions.friction_N);
        const WholeSteps delay = whole_steps(conditions.loop);
        const double rest_s = to_double(delay.rest_s);
        early_ = hand_.propagator(rest_s);
        late_ = hand_.propagator(conditions.loop.step_s - rest_s);
        under_way_.assign(static_cast<std::size_t>(delay.count) + 1, 0.0);
    }

    // to the next sample; allocates nothing
    void step() {
        double force_N = conditions_.loop.stiffness_N_per_m * sampled_m();
        if (conditions_.one_sided) force_N = std::max(force_N, 0.0);
        if (conditions_.force_limit_N > 0)
            force_N = std::clamp(force_N, -conditions_.force_limit_N, conditions_.force_limit_N);
        // One more place than whole steps: what is overwritten last is what the hand still feels until the next arrives.
        const std::size_t size = under_way_.size();
        const double felt_N = under_way_[next_];
        under_way_[next_] = force_N;
        next_ = next_ + 1 == size ? 0 : next_ + 1;
        if (early_.duration_s > 0) move(early_, felt_N);
        move(late_, under_way_[next_]);
    }

    // Changes the press force, N, from now on.
    void press(double press_N) { conditions_.press_N = press_N; }
    void rub(double friction_N) { hand_.rub(friction_N); }

    double position_m() const { return hand_.position_m(); }
    double velocity_m_per_s() const { return hand_.velocity_m_per_s(); }
    // p as the encoder says
    double sampled_m() const {
        const double step_m = conditions_.encoder_step_m;
        return step_m > 0 ? step_m * std::round(position_m() / step_m) : position_m();
    }

    double energy_J() const {
        return energy_J_;
    }  // that the hand has put into the force: below zero the loop drives it

  private:
    void move(const Propagator& propagator, double force_N) {
        const double from_m = position_m();
        hand_.advance(propagator, conditions_.press_N - force_N);
        energy_J_ += force_N * (position_m() - from_m);
    }

    LoopConditions conditions_;
    HandMotion hand_;
    Propagator early_, late_;        // before and after the next force arrives
    std::vector<double> under_way_;  // forces, oldest at next_
    std::size_t next_ = 0;
    double energy_J_ = 0;
};

}  // namespace thimble
