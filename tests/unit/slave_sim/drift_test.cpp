// Many steps without drift. The next state of a surface follows from its last one and the needle. So a surface that
// repeats itself to the bit while the needle does repeats itself for ever.
#include <algorithm>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/slave_sim/every_solver.hpp"

namespace thimble {
namespace {

class Drift : public EverySolver {};
THIMBLE_EVERY_SOLVER(Drift);

// A needle that goes round and round, one position a step.
struct Round {
    const char* name;
    double step_s;
    int settled_after;  // rounds
    std::vector<double> needle_m;
};

// A closed polygon of a thousand corners at 1 kHz, 30 to 40 mm beneath the surface's rest, at up to 30 mm/s.
Round stirring() {
    Round round{"stirring", 1e-3, 1000, {}};
    for (int i = 1; i <= 1000; ++i) {
        const int there_and_back = std::min(i, 1000 - i);
        const int ripple = (i * 7) % 40 < 20 ? (i * 7) % 20 : 20 - (i * 7) % 20;
        round.needle_m.push_back(0.05 + 2e-5 * there_and_back + 1e-6 * ripple);
    }
    return round;
}

// In and out at 60 mm/s and a wait of 1 s: touches, pierces and leaves.
Round insertions() {
    Round round{"insertions", 0.05, 100, {}};
    for (int i = 1; i <= 10; ++i) round.needle_m.push_back(0.0155 + 0.003 * i);
    for (int i = 9; i >= 0; --i) round.needle_m.push_back(0.0155 + 0.003 * i);
    round.needle_m.insert(round.needle_m.end(), 20, 0.0155);
    return round;
}

using Bits = std::vector<std::tuple<TissuePhase, double, double, double>>;

Bits go_round(TissueSolver& tissue, const Round& round) {
    Bits bits;
    for (const double position_m : round.needle_m) {
        Transitions events;
        tissue.advance(round.step_s, position_m, events);
        for (const Transition& e : events) bits.emplace_back(phase_named(e.phase), e.offset_s, 0, 0);
        const TissueState s = tissue.state();
        bits.emplace_back(s.phase, s.position_surface_m, s.velocity_surface_m_per_s, s.force_N);
    }
    return bits;
}

TEST_P(Drift, ASurfaceRepeatsItselfToTheBit) {
    for (const Round& round : {stirring(), insertions()}) {
        const auto tissue = make(TissueParameters{});
        tissue->reset(round.needle_m.back());
        for (int i = 0; i < round.settled_after; ++i) go_round(*tissue, round);
        const Bits settled = go_round(*tissue, round);
        int rounds = 1;  // rounding errors may alternate
        while (rounds <= 10 && go_round(*tissue, round) != settled) ++rounds;
        EXPECT_LE(rounds, 10) << round.name;
    }
}

}  // namespace
}  // namespace thimble
