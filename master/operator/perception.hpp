// From the physical stimulus to "this is the fixture" and "I have lost it".
//     s = s_raw (1 + w n(t)),  n: unit Ornstein-Uhlenbeck, w: Weber fraction of the modality
//     fixture felt: s > theta,  theta = min(theta of the subject, 0.9 x full scale of the display in use)
//     contact lost: s < 0.1 N for longer than 20 ms
// Display and actuator delays are not here: a percept arrives when skin or eye get it.
#pragma once

#include <cmath>
#include <cstdint>
#include <utility>

#include "master/operator/noise.hpp"
#include "master/operator/operator_parameters.hpp"
#include "master/operator/operator_port.hpp"

namespace thimble {

// The brain's clock.
inline constexpr Duration kBrainTick = std::chrono::milliseconds(1);
inline std::int64_t brain_ticks(double seconds) { return std::llround(seconds / to_seconds(kBrainTick)); }

struct Sensation {
    double signal_N = 0;  // s
    bool fixture_felt = false;
    bool contact_lost = false;
};

class Perception {
  public:
    Perception(const PerceptionParameters& parameters, const Subject& subject, const OperatorTask& task);

    // Once per brain tick. `force_hand_N` is what the handle applies; the modality decides which stimulus
    // counts.
    Sensation sense(double force_hand_N, const Percept& percept);

    double criterion_N() const { return criterion_N_; }

  private:
    double stimulus_N(double force_hand_N, const Percept& percept) const;

    Modality modality_;
    double weber_;
    double criterion_N_;
    double lost_N_;
    std::int64_t lost_after_;  // ticks
    std::int64_t below_ = 0;   // ticks
    OrnsteinUhlenbeck noise_;
};

// Delay of each decision, drawn anew: T = T_m g_subject g_subject,m exp(sigma xi - sigma^2 / 2),
// sigma^2 = ln(1 + cv^2). In whole brain ticks.
class ReactionTimes {
  public:
    ReactionTimes(const ReactionParameters& parameters, const Subject& subject, const OperatorTask& task);

    // Felt or lost, through the modality. The first one bears what a switch since the trial before costs.
    std::int64_t to_fixture() { return draw(fixture_s_ + std::exchange(switch_s_, 0)); }
    std::int64_t to_touch() { return draw(touch_s_); }  // needle seen to touch the tissue
    std::int64_t to_beep() { return draw(beep_s_); }

  private:
    std::int64_t draw(double median_s);

    double sigma_;
    double fixture_s_, touch_s_, beep_s_;
    double switch_s_;  // until it was paid
    RandomStream random_;
};

// The cost of a switch: to another sense (joints, skin, eyes), and to another hand that feels.
double switch_cost_s(const ReactionParameters& parameters, Modality before, Modality now);

// The key of one purpose in this trial.
StreamKey stream_key(const OperatorTask& task, Purpose purpose);

}  // namespace thimble
