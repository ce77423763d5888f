// The running loop of stability with a compensator at the handle and a network that shakes and loses. Towards the wall
// nothing delays; back, packet k (the reading at k h and its force, or a wave) needs T and up to the jitter more, each its own
// draw, so that later ones may overtake. The newest sample that came counts. A force acts when it comes, with a compensator at
// the next sample. Without compensator, jitter and loss it is LoopSimulator.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/control/controller_ends.hpp"
#include "common/control/wave_channel.hpp"
#include "common/control/wave_variables.hpp"
#include "common/random.hpp"
#include "stability/hand_motion.hpp"
#include "stability/loop_simulator.hpp"

namespace thimble {

struct CompensatedConditions {
    LoopConditions loop;  // one-sided
    ControlSettings control{};
    double jitter_s = 0;    // delays are uniform in [T, T + jitter]
    double loss = 0;        // share of packets, below 1
    double mean_burst = 1;  // packets lost in a row, on average; 1: each by itself
    std::uint64_t seed = 1;
};

class CompensatedLoop {
  public:
    // Throws Error (usage) where it is no loop, no network or no compensator.
    CompensatedLoop(const CompensatedConditions& conditions, double position_m, double velocity_m_per_s);
    ~CompensatedLoop();

    void step();  // to the next sample

    double position_m() const { return hand_.position_m(); }
    double sampled_m() const;
    double energy_J() const { return energy_J_; }  // as LoopSimulator's
    // Mean age of the position behind the force that acted; NaN for a force of the handle's own (local fixture).
    double effective_delay_s() const;

  private:
    struct Packet;
    struct Waves;
    struct TwoPorts;

    double force_limit_N() const;  // infinite: none
    void send(double reading_m);
    bool lost();
    void deliver(const Packet& packet);
    void set_force();
    void move(double from_s, double to_s);
    bool at_once() const { return !waves_ && !two_ports_ && (!end_ || end_->has(THIMBLE_AT_ONCE)); }
    void meet_wall(double reading_m, Packet& packet);
    Propagator propagator(double duration_s);

    CompensatedConditions conditions_;
    HandMotion hand_;
    double step_s_;
    std::unique_ptr<HandleEnd>
        end_;  // of any controller but waves and two ports, which act in the same sample here
    std::unique_ptr<SlaveEnd> slave_end_;
    WaveBurst sent_;
    double read_before_m_ = 0;
    bool own_force_ = false;  // the handle's, which has no age
    std::unique_ptr<Waves> waves_;
    std::unique_ptr<TwoPorts> two_ports_;
    RandomStream delays_, losses_;
    bool losing_ = false;
    std::vector<std::vector<Packet>> arriving_;  // by sample modulo size
    std::vector<Propagator> known_;
    std::int64_t sample_ = 0, newest_ = -1, asked_of_ = -1;
    double asked_N_ = 0, force_N_ = 0, energy_J_ = 0;
    double age_s2_ = 0, aged_s_ = 0;
};

}  // namespace thimble
