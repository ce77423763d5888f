// Many steps without drift. How many comes from the build: 1e9 in release, fewer under sanitizers and in debug,
// as the output says. hard_cases_reference_test.cpp compares single insertions with 100-digit numbers.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/slave_sim/every_solver.hpp"

namespace thimble {
namespace {

constexpr std::uint64_t kSteps = THIMBLE_DRIFT_STEPS;

class Drift : public EverySolver {};
THIMBLE_EVERY_SOLVER(Drift);

// A closed polygon of a thousand corners at 1 kHz, 30 to 40 mm beneath the surface's rest, at up to 30 mm/s.
std::vector<double> stirring() {
    std::vector<double> needle_m;
    for (int i = 1; i <= 1000; ++i) {
        const int there_and_back = std::min(i, 1000 - i);
        const int ripple = (i * 7) % 40 < 20 ? (i * 7) % 20 : 20 - (i * 7) % 20;
        needle_m.push_back(0.03 + 2e-5 * there_and_back + 1e-6 * ripple);
    }
    return needle_m;
}

// The states of the last of so many periods.
std::vector<TissueState> stir(TissueSolver& tissue, const std::vector<double>& needle_m,
                              std::uint64_t periods) {
    Transitions events;
    std::vector<TissueState> last;
    for (std::uint64_t i = 1; i <= periods; ++i) {
        for (const double position_m : needle_m) {
            tissue.advance(1e-3, position_m, events);
            if (i == periods) last.push_back(tissue.state());
        }
    }
    EXPECT_EQ(events.size(), 0u);
    EXPECT_EQ(tissue.state().phase, TissuePhase::kPenetrated);
    return last;
}

// After 1e6 steps (1000 s, 350 time constants) the surface repeats itself with the needle. Each rounding error
// fades with the motion, so all of them together stay within those of one time constant. The rest position is
// 0, so that the state carries no rounding of its own.
TEST_P(Drift, NoneInTheTissue) {
    TissueParameters p;
    p.rest_position_m = 0;
    const std::vector<double> needle_m = stirring();
    const auto tissue = make(p);
    tissue->reset(needle_m.back());
    constexpr std::uint64_t kFirst = 1'000'000;
    const std::uint64_t steps = std::max(2 * kFirst, exact() ? kSteps : kSteps / 10);
    const auto first = stir(*tissue, needle_m, kFirst / needle_m.size());
    const auto last = stir(*tissue, needle_m, (steps - kFirst) / needle_m.size());
    double moved_m = 0;
    for (std::size_t i = 0; i < first.size(); ++i) {
        moved_m = std::max(moved_m, std::abs(last[i].position_surface_m - first[i].position_surface_m));
        EXPECT_NEAR(last[i].velocity_surface_m_per_s, first[i].velocity_surface_m_per_s, 1e-15);
    }
    std::printf("[ measured ] %s, after %.3g steps: %.2g m\n", std::string(GetParam()).c_str(),
                static_cast<double>(steps), moved_m);
    EXPECT_LE(moved_m, 1e-16);
}

// In and out at 60 mm/s and a wait of 1 s, in steps of 50 ms.
std::vector<double> insertion_cycle() {
    std::vector<double> needle_m;
    for (int i = 1; i <= 10; ++i) needle_m.push_back(0.0155 + 0.003 * i);
    for (int i = 9; i >= 0; --i) needle_m.push_back(0.0155 + 0.003 * i);
    for (int i = 0; i < 20; ++i) needle_m.push_back(0.0155);
    return needle_m;
}

// Every insertion touches, pierces and leaves at the same instants, once the first hundred have settled.
TEST(DriftExact, NoneInTheTimesOfAMillionInsertions) {
    const std::vector<double> needle_m = insertion_cycle();
    const auto tissue = solver_maker({})({});
    tissue->reset(needle_m.back());
    const auto insertion = [&] {
        Transitions events(64);
        std::vector<std::pair<double, TissuePhase>> happened;
        for (std::size_t step = 0; step < needle_m.size(); ++step) {
            events.clear();
            tissue->advance(0.05, needle_m[step], events);
            for (const Transition& e : events)
                happened.emplace_back(0.05 * static_cast<double>(step) + e.offset_s, phase_named(e.phase));
        }
        return happened;
    };
    for (int i = 0; i < 100; ++i) insertion();
    const auto settled = insertion();
    ASSERT_GE(settled.size(), 3u);
    const std::uint64_t cycles = std::max<std::uint64_t>(2000, kSteps / 1000);
    double worst_s = 0;
    for (std::uint64_t i = 0; i < cycles; ++i) {
        const auto happened = insertion();
        ASSERT_EQ(happened.size(), settled.size()) << i;
        for (std::size_t k = 0; k < happened.size(); ++k) {
            ASSERT_EQ(happened[k].second, settled[k].second) << i;
            worst_s = std::max(worst_s, std::abs(happened[k].first - settled[k].first));
        }
    }
    std::printf("[ measured ] %.3g insertions, %zu transitions each: within %.2g s\n",
                static_cast<double>(cycles), settled.size(), worst_s);
    EXPECT_LE(worst_s, 1e-14);
}

}  // namespace
}  // namespace thimble
