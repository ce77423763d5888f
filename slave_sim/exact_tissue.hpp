// The tissue automaton stepped exactly: closed form within a phase, and the first root of each guard, however
// long the step.
#pragma once

#include <array>
#include <cstdint>

#include "slave_sim/second_order.hpp"
#include "slave_sim/tissue_solver.hpp"

namespace thimble {

class ExactTissue final : public TissueSolver {
  public:
    // The most evaluations of a step, give or take one search: enough for a thousand transitions. One that would cost
    // more is not searched to its end.
    static constexpr std::uint64_t kMostEvaluations = 20'000;

    explicit ExactTissue(const TissueParameters& parameters);

    // Steps with 64 transitions in a millionth of their time, or with more work than a step may cost, which
    // ended without looking for more.
    std::uint64_t unresolved_steps() const { return unresolved_steps_; }
    // Propagators computed, comparable with the evaluations of a general-purpose solver.
    std::uint64_t evaluations() const { return evaluations_; }

  protected:
    void move(double duration_s, double needle_end_m, Transitions& transitions) override;

  private:
    struct Leg;

    bool contact_leg(Leg& leg);
    bool moving_leg(Leg& leg);
    bool may_cross(const Leg& leg, const SecondOrder& law, double acceleration) const;
    void give_up(Leg& leg);
    void agree_with_guards(const Leg& leg);
    double crossing(Leg& leg, const SecondOrder& law, const Propagator& p, double acceleration);
    double beyond_s(double limit_N, double side, const Leg& leg) const;
    void enter(TissuePhase phase, double after_s, Leg& leg);

    std::array<SecondOrder, 2> laws_;     // of the surface alone, and with the needle in it
    std::array<Propagator, 2> cached_{};  // for the duration of the last step
    std::uint64_t unresolved_steps_ = 0;
    std::uint64_t evaluations_ = 0;
    std::uint64_t evaluations_before_ = 0;  // the step
};

}  // namespace thimble
