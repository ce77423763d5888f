#include "master/operator/behaviour.hpp"

#include <algorithm>
#include <numbers>

#include "common/math/portable.hpp"

namespace thimble {
namespace {

constexpr double kTickSeconds = to_seconds(kBrainTick);

// Speed of a raised-cosine stop from 1 to 0, u in [0, 1].
double braking(double u) { return 0.5 * (1 + portable::cos(std::numbers::pi * u)); }

// Speed of a minimum-jerk unit step in unit time (Flash and Hogan 1985).
double minimum_jerk_speed(double u) {
    const double bump = u * (1 - u);
    return 30 * bump * bump;
}

double trial_speed(const OperatorParameters& parameters, const Subject& subject, const OperatorTask& task) {
    RandomStream random(stream_key(task, Purpose::kSpeed));
    const double factor = 1 + parameters.behaviour.speed_trial_variation * random.normal();
    // A draw four deviations below the mean must not make a hand that never arrives.
    return subject.speed_insert_needle_m_per_s * std::max(factor, 0.1) / parameters.behaviour.position_scale;
}

// A power law of practice, 1 in the first trial.
double learned_by(std::uint32_t trial, double exponent) {
    return portable::exp(exponent * portable::log1p(trial > 0 ? trial - 1.0 : 0.0));
}

}  // namespace

Behaviour::Behaviour(const OperatorParameters& parameters, const Subject& subject, const OperatorTask& task)
    : parameters_(parameters.behaviour),
      push_m_(subject.push_m),
      press_m_(task.modality == Modality::kHF ? subject.press_N / subject.arm_stiffness_N_per_m : 0),
      learned_(learned_by(task.trial, parameters.behaviour.learning_exponent)),
      insert_m_per_s_(trial_speed(parameters, subject, task)),
      speed_noise_fraction_(parameters.noise.speed_noise_fraction),
      cocontracts_(task.modality == Modality::kHF),
      lag_gain_(-portable::expm1(-kTickSeconds / parameters.behaviour.speed_lag_s)),
      brake_ticks_(std::max<std::int64_t>(brain_ticks(parameters.behaviour.brake_s), 1)),
      stride_ticks_(std::max<std::int64_t>(
          brain_ticks(parameters.behaviour.recovery == Recovery::kPush ? parameters.behaviour.push_s
                                                                       : parameters.behaviour.relax_s),
          1)),
      refractory_ticks_(brain_ticks(parameters.behaviour.refractory_s)),
      reaction_(parameters.reaction, subject, task),
      speed_noise_(stream_key(task, Purpose::kSpeedNoise), parameters.noise.speed_noise_correlation_s,
                   kBrainTick) {}

const Intention& Behaviour::step(const Sensation& sensation, bool touching, bool beep,
                                 double position_arm_m) {
    if (phase_ == BehaviourPhase::kDone) return intention_;
    perceive(sensation, touching, beep);
    decide(position_arm_m);
    move();
    ++now_;
    return intention_;
}

void Behaviour::perceive(const Sensation& sensation, bool touching, bool beep) {
    if (beep && withdraw_ == kUndecided) withdraw_ = now_ + reaction_.to_beep();
    if (phase_ == BehaviourPhase::kApproach) {
        if (touching && next_ == kUndecided) next_ = now_ + reaction_.to_touch();
    } else if (phase_ == BehaviourPhase::kInsert) {
        if (sensation.fixture_felt && next_ == kUndecided) next_ = now_ + reaction_.to_fixture();
    } else if (phase_ != BehaviourPhase::kWithdraw) {
        perceive_loss(sensation);
    }
}

void Behaviour::perceive_loss(const Sensation& sensation) {
    if (sensation.contact_lost && !was_lost_) {
        ++contact_losses_;
        if (cocontracts_) {
            intention_.stiffness_factor =
                std::min(intention_.stiffness_factor + learned_ * parameters_.cocontraction,
                         1 + parameters_.cocontraction_limit);
        }
    }
    was_lost_ = sensation.contact_lost;
    const bool ready = phase_ == BehaviourPhase::kHold && now_ - last_action_ >= refractory_ticks_;
    if (ready && sensation.contact_lost && next_ == kUndecided) next_ = now_ + reaction_.to_fixture();
}

void Behaviour::decide(double position_arm_m) {
    const std::int64_t spent = now_ - entered_;
    const bool decided = next_ <= now_;
    if (withdraw_ <= now_ && phase_ != BehaviourPhase::kWithdraw) return enter(BehaviourPhase::kWithdraw);
    switch (phase_) {
        case BehaviourPhase::kApproach:
            return enter_if(decided, BehaviourPhase::kInsert);
        case BehaviourPhase::kInsert:
            return enter_if(decided, BehaviourPhase::kBrake);
        case BehaviourPhase::kBrake:
            return enter_if(spent >= brake_ticks_, BehaviourPhase::kHold);
        case BehaviourPhase::kHold:
            if (decided) recover(position_arm_m);
            return;
        case BehaviourPhase::kPush:
            return enter_if(spent >= stride_ticks_, BehaviourPhase::kHold);
        case BehaviourPhase::kRelax:
            return enter_if(spent >= stride_ticks_, BehaviourPhase::kInsert);
        case BehaviourPhase::kWithdraw:
            return enter_if(intention_.position_m < 0, BehaviourPhase::kDone);
        case BehaviourPhase::kDone:
            return;
    }
}

void Behaviour::enter(BehaviourPhase phase) {
    phase_ = phase;
    entered_ = now_;
    next_ = kUndecided;
    entry_m_per_s_ = intention_.velocity_m_per_s;
    if (phase == BehaviourPhase::kHold) last_action_ = now_;
    // The operator seeks the contact again. Losing it once more is another loss.
    if (phase == BehaviourPhase::kInsert) was_lost_ = false;
}

void Behaviour::recover(double position_arm_m) {
    ++recoveries_;
    if (parameters_.recovery == Recovery::kPush) {
        stride_m_ = push_m_;
        push_m_ *= parameters_.push_growth;
        return enter(BehaviourPhase::kPush);
    }
    // Never forward: an arm that was thrown beyond what was meant is no reason to push.
    stride_m_ = std::min(position_arm_m - intention_.position_m, 0.0);
    slowing_ = std::max(slowing_ * parameters_.slowing / learned_, parameters_.slowest);
    enter(BehaviourPhase::kRelax);
}

void Behaviour::move() {
    // Middle of the tick: the strides then add up to what was meant.
    const double spent = static_cast<double>(now_ - entered_) + 0.5;
    double& velocity = intention_.velocity_m_per_s;
    switch (phase_) {
        case BehaviourPhase::kApproach:
            approach_speed(parameters_.speed_free_needle_m_per_s / parameters_.position_scale);
            break;
        case BehaviourPhase::kInsert:
            approach_speed(slowing_ * insert_m_per_s_ * (1 + speed_noise_fraction_ * speed_noise_.next()));
            break;
        case BehaviourPhase::kBrake:
            velocity = entry_m_per_s_ * braking(spent / static_cast<double>(brake_ticks_)) +
                       press_m_ / (static_cast<double>(brake_ticks_) * kTickSeconds) *
                           minimum_jerk_speed(spent / static_cast<double>(brake_ticks_));
            break;
        case BehaviourPhase::kPush:
        case BehaviourPhase::kRelax:
            velocity = stride_m_ / (static_cast<double>(stride_ticks_) * kTickSeconds) *
                       minimum_jerk_speed(spent / static_cast<double>(stride_ticks_));
            break;
        case BehaviourPhase::kWithdraw:
            approach_speed(-parameters_.speed_withdraw_needle_m_per_s / parameters_.position_scale);
            break;
        case BehaviourPhase::kHold:
        case BehaviourPhase::kDone:
            velocity = 0;
            break;
    }
    intention_.position_m += velocity * kTickSeconds;
}

void Behaviour::approach_speed(double target_m_per_s) {
    intention_.velocity_m_per_s += lag_gain_ * (target_m_per_s - intention_.velocity_m_per_s);
}

}  // namespace thimble
