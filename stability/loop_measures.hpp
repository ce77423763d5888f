// Measures of a running loop, taken as on a real rig, without theory.
//
// In the linear mode the growth rate: a decaying and a growing oscillation of the same size now differ, whatever their sizes are.
// (Peak-to-peak alone takes a slowly dying transient for an oscillation: 5 to 23 % too low a boundary after 8 s.) In the full mode
// the outcome of a hold against the wall.
#pragma once

#include <span>

#include "common/shared_values.hpp"
#include "stability/loop_simulator.hpp"

namespace thimble {

// Per sample, from a trace of one dominant oscillation about zero: least squares of x[n+2p] = a x[n+p] + b x[n] with p a
// quarter period (Prony with a stride), rho = |mu|^(1/p) for the greater root of mu^2 - a mu - b. Where that is not
// what the trace did from its first half to its second (several modes at once, or a creep without turns), what it did.
double growth_per_sample(std::span<const double> trace);

// Of the linear loop let go from 5 mm: ln(rho) / h after the first half of six seconds, of sixty delays, or of 400
// delays beyond 0.5 s. `encoder_step_m` of 0: none.
double measured_growth_per_s(const SampledLoop& loop, double encoder_step_m);

struct MeasuredStiffness {
    double stiffness_N_per_m = 0;  // at which growth turns to decay
    int runs = 0;
};
// Runs it, `stiffness_N_per_m` not read, with ever closer stiffness until that is known to `relative`.
MeasuredStiffness measured_critical_stiffness(const SampledLoop& loop, double encoder_step_m,
                                              double relative);

// Of the running loop without encoder at 10 kHz, half a step added, to 0.1 us; delays up to 20 ms are looked at.
double measured_critical_delay_s(const HeldMass& hand, double stiffness_N_per_m);

enum class HoldClass : char { kSettles = 'S', kMarginal = 'M', kOscillates = 'O' };

// Of the last three seconds of a hold.
struct HoldOutcome {
    HoldClass label = HoldClass::
        kMarginal;  // S: contact kept, <= 0.1 mm; O: lost once a second or >= 1 mm (at the needle); else M
    bool energy_grows = false;  // the loop gave the hand more than 10 mJ
    double peak_to_peak_m = 0;  // at the handle
    double losses_per_s = 0;    // of contact
    double energy_J = 0;        // see LoopSimulator, of the whole hold
};

struct HoldPlan {
    double duration_s = 12;
    double position_scale = kPositionScale;  // handle to needle
    double start_m = -5e-3, start_m_per_s = 0.1;
};
// Watches a hold sample by sample.
class HoldWatch {
  public:
    HoldWatch(const HoldPlan& plan, double step_s);
    bool over() const { return done_ >= samples_; }
    // After a sample: where it was before, where it is.
    void add(double sampled_before_m, double sampled_m, double position_m, double energy_J);
    HoldOutcome outcome() const;

  private:
    double position_scale_;
    long samples_, watched_, done_ = 0, losses_ = 0;
    double low_m_ = 0, high_m_ = 0, energy_before_J_ = 0, energy_J_ = 0;
    bool touches_ = false;
};

// Outcome of a running loop that starts as `plan` says.
template <class Loop>
HoldOutcome watched_hold(Loop& run, const HoldPlan& plan, double step_s) {
    HoldWatch watch(plan, step_s);
    for (double before_m = run.sampled_m(); !watch.over();) {
        run.step();
        const double now_m = run.sampled_m();
        watch.add(before_m, now_m, run.position_m(), run.energy_J());
        before_m = now_m;
    }
    return watch.outcome();
}
HoldOutcome measured_hold(const LoopConditions& conditions, const HoldPlan& plan);

}  // namespace thimble
