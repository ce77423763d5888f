// Many steps without drift. How many comes from the build: 1e9 in release, fewer under sanitizers and in debug,
// as the output says. The truth is solved in 100-digit numbers, by none of the solvers.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bench/reference_tissue.hpp"
#include "slave_sim/solvers.hpp"
#include "tests/unit/slave_sim/every_solver.hpp"
#include "tests/unit/slave_sim/periodic_motion.hpp"

namespace thimble {
namespace {

constexpr std::uint64_t kSteps = THIMBLE_DRIFT_STEPS;

class Drift : public EverySolver {};
THIMBLE_EVERY_SOLVER(Drift);

// A closed polygon of a thousand corners at 1 kHz, 30 to 40 mm beneath the surface's rest, at up to 30 mm/s.
Polygon stirring() {
    Polygon polygon{1e-3, {}};
    for (int i = 1; i <= 1000; ++i) {
        const int there_and_back = std::min(i, 1000 - i);
        const int ripple = (i * 7) % 40 < 20 ? (i * 7) % 20 : 20 - (i * 7) % 20;
        polygon.needle_m.push_back(0.03 + 2e-5 * there_and_back + 1e-6 * ripple);
    }
    return polygon;
}

struct Deviation {
    double position_m = 0;
    double velocity_m_per_s = 0;
};

// `periods` of the polygon, the last of which is compared.
Deviation stir(TissueSolver& tissue, const Polygon& polygon, const std::vector<SurfaceSample>& truth,
               std::uint64_t periods) {
    const double rest_m = tissue.parameters().rest_position_m;
    Transitions events;
    Deviation worst;
    for (std::uint64_t i = 0; i < periods; ++i) {
        for (std::size_t j = 0; j < polygon.needle_m.size(); ++j) {
            tissue.advance(polygon.step_s, rest_m + polygon.needle_m[j], events);
            if (i + 1 < periods) continue;
            const TissueState s = tissue.state();
            worst.position_m =
                std::max(worst.position_m, std::abs(s.position_surface_m - rest_m - truth[j].position_m));
            worst.velocity_m_per_s = std::max(
                worst.velocity_m_per_s, std::abs(s.velocity_surface_m_per_s - truth[j].velocity_m_per_s));
        }
    }
    EXPECT_EQ(events.size(), 0u);
    EXPECT_EQ(tissue.state().phase, TissuePhase::kPenetrated);
    return worst;
}

void report(const std::string& what, std::uint64_t steps, const Deviation& d) {
    std::printf("[ measured ] %s, after %.3g steps: %.2g m, %.2g m/s\n", what.c_str(),
                static_cast<double>(steps), d.position_m, d.velocity_m_per_s);
}

// From 1e6 steps (1000 s, 350 time constants) on nothing is left but rounding, and it does not grow: each error
// fades with the motion, so all of them together stay within those of one time constant. The rest position is
// 0, so that the state carries no rounding of its own; the rules are compared with their own periodic motion.
TEST_P(Drift, NoneInTheTissue) {
    TissueParameters p;
    p.rest_position_m = 0;
    const Polygon polygon = stirring();
    const auto truth = periodic_motion(GetParam(), p, polygon);
    const auto tissue = make(p);
    tissue->reset(polygon.needle_m.back());
    constexpr std::uint64_t kFirst = 1'000'000;
    const std::uint64_t steps = std::max(2 * kFirst, exact() ? kSteps : kSteps / 10);
    const std::uint64_t period = polygon.needle_m.size();
    const Deviation first = stir(*tissue, polygon, truth, kFirst / period);
    const Deviation last = stir(*tissue, polygon, truth, (steps - kFirst) / period);
    report(std::string(GetParam()), kFirst, first);
    report(std::string(GetParam()), steps, last);
    EXPECT_LE(first.position_m, 1e-16);
    EXPECT_LE(last.position_m, 1e-16);
    EXPECT_LE(last.position_m, 2 * first.position_m);
    EXPECT_LE(first.velocity_m_per_s, 1e-15);
    EXPECT_LE(last.velocity_m_per_s, 1e-15);
}

struct Happening {
    std::size_t step;  // of the cycle
    double offset_s;
    TissuePhase phase;
};

// In and out at 60 mm/s and a wait of 1 s, in steps of 50 ms.
std::vector<double> insertion_cycle() {
    std::vector<double> needle_m;
    for (int i = 1; i <= 10; ++i) needle_m.push_back(0.0155 + 0.003 * i);
    for (int i = 9; i >= 0; --i) needle_m.push_back(0.0155 + 0.003 * i);
    for (int i = 0; i < 20; ++i) needle_m.push_back(0.0155);
    return needle_m;
}

constexpr double kCycleStep_s = 0.05;

// The cycle that the cycles converge to: after 80, of half the memory each, 24 digits are settled.
std::vector<Happening> settled_cycle(const TissueParameters& p, const std::vector<double>& needle_m) {
    constexpr std::size_t kCycles = 80;
    ReferenceTissue truth{ReferenceParameters(p)};
    truth.reset(needle_m.back());
    std::size_t before = 0;
    std::vector<Happening> cycle;
    for (std::size_t i = 0; i < kCycles; ++i) {
        for (std::size_t j = 0; j < needle_m.size(); ++j) {
            const ReferenceNumber start_s = truth.t_s();
            truth.step(kCycleStep_s, needle_m[j]);
            for (; before < truth.events().size(); ++before) {
                if (i + 1 < kCycles) continue;
                const ReferenceEvent& e = truth.events()[before];
                cycle.push_back({j, ReferenceNumber(e.t_s - start_s).convert_to<double>(), e.phase});
            }
        }
    }
    return cycle;
}

// Every insertion touches, pierces and leaves at the same instants.
TEST(DriftExact, NoneInTheTimesOfAMillionInsertions) {
    const TissueParameters p;
    const std::vector<double> needle_m = insertion_cycle();
    const std::vector<Happening> truth = settled_cycle(p, needle_m);
    ASSERT_GE(truth.size(), 3u);
    const std::uint64_t cycles = std::max<std::uint64_t>(2000, kSteps / 1000);
    const auto tissue = solver_maker({})(p);
    tissue->reset(needle_m.back());
    Transitions events(64);
    constexpr std::uint64_t kRunIn = 100;
    double worst_s = 0;
    for (std::uint64_t i = 0; i < cycles + kRunIn; ++i) {
        std::size_t found = 0;
        for (std::size_t j = 0; j < needle_m.size(); ++j) {
            events.clear();
            tissue->advance(kCycleStep_s, needle_m[j], events);
            if (i < kRunIn) continue;
            for (const Transition& e : events) {
                ASSERT_LT(found, truth.size()) << i;
                ASSERT_EQ(phase_named(e.phase), truth[found].phase) << i;
                ASSERT_EQ(j, truth[found].step) << i;
                worst_s = std::max(worst_s, std::abs(e.offset_s - truth[found].offset_s));
                ++found;
            }
        }
        ASSERT_EQ(found, i < kRunIn ? 0 : truth.size()) << i;
    }
    std::printf("[ measured ] %.3g insertions, %zu transitions each: within %.2g s\n",
                static_cast<double>(cycles), truth.size(), worst_s);
    EXPECT_LE(worst_s, 1e-14);
}

}  // namespace
}  // namespace thimble
