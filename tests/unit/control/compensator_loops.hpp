// The hand against the wall through each compensator, over an ideal network: nothing towards the wall, a constant delay back.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/control/port_compensator.hpp"
#include "common/control/port_observer.hpp"
#include "tests/unit/control/held_hand.hpp"

namespace thimble::test {

// Once per tick: the reading and the force held on the way there; the force until the next tick.
using Controller = std::function<double(double position_m, double force_held_N)>;

struct LoopSample {
    double position_m, velocity_m_per_s, force_N;  // the force that was held until here
};

struct LoopResult {
    std::vector<LoopSample> samples;  // of each tick, from 0
    double least_J = 0, last_J = 0;   // work of the hand, true positions
    const LoopSample& last() const { return samples.back(); }
    // Of the last tenth.
    double swing_m() const;
    LoopSample mean() const;
};

LoopResult run_loop(const HandCase& hand, const Controller& controller, int ticks);

// Reading -> wall force, delayed.
Controller plain_wall(const HandCase& hand, std::size_t delay);
// The same, with a compensator at the handle and its force limited.
Controller at_the_handle(const HandCase& hand, std::size_t delay,
                         std::shared_ptr<PortCompensator> compensator);
Controller with_waves(const HandCase& hand, std::size_t delay, double impedance_Ns_per_m);
// "hf", "wave", "tdpa", "eba", "ebalc", "tank" with the numbers of the golden traces.
Controller named(const std::string& method, const HandCase& hand, std::size_t delay);

}  // namespace thimble::test
