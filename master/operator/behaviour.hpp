// What the operator intends, from the first touch to the withdrawal: an intermittent controller of the hand's
// equilibrium point (x_cmd, v_cmd). "Insert until you perceive the fixture, stop, wait for the beep,
// withdraw", taken literally: nobody retreats from too deep a stop. An operator who loses contact recovers it in one of two ways:
//
//     APPROACH --touch seen--> INSERT --fixture felt--> BRAKE --> HOLD
//     kApproach:  HOLD --contact lost--> RELAX --> INSERT, slower each time
//     kPush:      HOLD --contact lost--> PUSH --> HOLD, harder each time
//     any of these --beep--> WITHDRAW --x_cmd < 0--> DONE
//
// Each arrow with a cause comes one reaction time after it. RELAX moves x_cmd to where the arm is felt to be,
// so that it pushes no longer: move and wait is what people do under delay (Ferrell 1965, 1966), and after a
// mistake they are slower (Rabbitt 1966).
#pragma once

#include <limits>

#include "master/operator/perception.hpp"

namespace thimble {

enum class BehaviourPhase : std::uint8_t {
    kApproach,
    kInsert,
    kBrake,
    kHold,
    kPush,
    kRelax,
    kWithdraw,
    kDone
};

// Of the hand: intended position and velocity, and how stiff the limb is held (1 = relaxed).
struct Intention {
    double position_m = 0;
    double velocity_m_per_s = 0;
    double stiffness_factor = 1;
};

class Behaviour {
  public:
    Behaviour(const OperatorParameters& parameters, const Subject& subject, const OperatorTask& task);

    // Once per brain tick. `touching` and `beep` must stay true once they were. `position_arm_m`: of the own
    // arm, as it is felt; what that takes is part of the reaction time.
    const Intention& step(const Sensation& sensation, bool touching, bool beep, double position_arm_m);

    BehaviourPhase phase() const { return phase_; }
    const Intention& intention() const { return intention_; }
    unsigned contact_losses() const { return contact_losses_; }  // perceived, after the stop
    unsigned recoveries() const { return recoveries_; }          // begun

  private:
    static constexpr std::int64_t kUndecided = std::numeric_limits<std::int64_t>::max();

    void perceive(const Sensation& sensation, bool touching, bool beep);
    void perceive_loss(const Sensation& sensation);
    void decide(double position_arm_m);
    void enter(BehaviourPhase phase);
    void enter_if(bool due, BehaviourPhase phase) {
        if (due) enter(phase);
    }
    void recover(double position_arm_m);
    void move();
    void approach_speed(double target_m_per_s);

    BehaviourParameters parameters_;
    double push_m_;          // of the next push, at the hand
    double press_m_;         // HF: with the stop
    double learned_;         // how much more is done after a loss than in the first trial
    double slowing_ = 1;     // of the insertion, after losses
    double insert_m_per_s_;  // of this trial, at the hand
    double speed_noise_fraction_;
    bool cocontracts_;  // only who feels the kicks
    double lag_gain_;
    std::int64_t brake_ticks_, stride_ticks_, refractory_ticks_;
    ReactionTimes reaction_;
    OrnsteinUhlenbeck speed_noise_;

    BehaviourPhase phase_ = BehaviourPhase::kApproach;
    Intention intention_;
    std::int64_t now_ = 0;      // ticks
    std::int64_t entered_ = 0;  // the phase
    std::int64_t last_action_ = 0;
    std::int64_t next_ = kUndecided;  // when the decision that ends this phase takes effect
    std::int64_t withdraw_ = kUndecided;
    double entry_m_per_s_ = 0;  // v_cmd when the phase began
    double stride_m_ = 0;       // of the push or the relaxation under way
    bool was_lost_ = false;
    unsigned contact_losses_ = 0, recoveries_ = 0;
};

}  // namespace thimble
