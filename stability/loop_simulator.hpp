// The sampled loop as it runs: hand and held force stepped exactly, so that what is measured is the loop and not a solver.
//
// The position p beyond the wall is sampled at k h; the force K p (one-sided, limited, of an encoder's steps if asked for) reaches
// the hand T later and is held for h. Every place where the force changes is known in advance: at most two exact steps per sample
// (slave_sim/second_order.hpp), and more with dry friction where the hand turns. Without the non-linear parts it is the loop of
// sampled_loop.hpp.
#pragma once

#include <cstddef>
#include <vector>

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

class LoopSimulator {
  public:
    // Starts with no force on its way. Throws Error (usage) as sampled_loop.hpp does.
    LoopSimulator(const LoopConditions& conditions, double position_m, double velocity_m_per_s);

    void step();  // to the next sample; allocates nothing

    // From now on.
    void press(double press_N) { conditions_.press_N = press_N; }
    void rub(double friction_N) { hand_.rub(friction_N); }

    double position_m() const { return hand_.position_m(); }
    double velocity_m_per_s() const { return hand_.velocity_m_per_s(); }
    double sampled_m() const;  // p as the encoder says
    double energy_J() const {
        return energy_J_;
    }  // that the hand has put into the force: below zero the loop drives it

  private:
    void move(const Propagator& propagator, double force_N);

    LoopConditions conditions_;
    HandMotion hand_;
    Propagator early_, late_;        // before and after the next force arrives
    std::vector<double> under_way_;  // forces, oldest at next_
    std::size_t next_ = 0;
    double energy_J_ = 0;
};

}  // namespace thimble
