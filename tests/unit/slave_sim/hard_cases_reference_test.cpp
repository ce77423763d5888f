// Hard cases whose truth has no formula of one line: whole needles through hard tissue against a solution in
// 100-digit numbers (bench/reference_tissue.hpp), for each solver. The test prints its measures, which stand in docs/speed.md.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bench/accuracy.hpp"
#include "common/error.hpp"
#include "slave_sim/exact_tissue.hpp"
#include "slave_sim/solvers.hpp"

namespace thimble {
namespace {

constexpr double kStep_s = 1e-3;

const ReferenceSolution& solution_of(const std::string& name) {
    static std::map<std::string, ReferenceSolution> kept;
    const auto found = kept.find(name);
    if (found != kept.end()) return found->second;
    return kept.emplace(name, solve_reference(problem_named(name))).first->second;
}

void print(std::string_view solver, const Problem& problem, const Accuracy& a) {
    std::printf("[ measured ] %-20s %-16s %.2g m, %.2g N, %zu of %zu transitions%s, %.2g s\n",
                std::string(solver).c_str(), std::string(problem.name).c_str(), a.position_m, a.force_N,
                a.events, a.events_reference, a.events_differ ? " (differ)" : "", a.event_time_s);
}

// Every problem of thimble-bench work-precision.
class HardReference : public testing::TestWithParam<std::string> {
  protected:
    const Problem& problem() const { return problem_named(GetParam()); }
    Accuracy judged(std::string_view solver) const {
        const auto tissue = solver_maker({solver, kStep_s})(problem().tissue);
        const Accuracy a = judge(problem(), solution_of(GetParam()), *tissue);
        print(solver, problem(), a);
        return a;
    }
};

std::vector<std::string> every_name() {
    std::vector<std::string> names;
    for (const Problem& problem : problems()) names.emplace_back(problem.name);
    return names;
}

INSTANTIATE_TEST_SUITE_P(Problems, HardReference, testing::ValuesIn(every_name()), [](const auto& name) {
    std::string text;
    for (const char c : name.param) text += c == '+' ? 'p' : c == '-' ? 'm' : c;
    return text;
});

// The needle's velocity in a step is the difference of two positions, each rounded. A surface that neither
// spring nor damper hold, as that of 1e6 kg, keeps what a touch gave it.
double rounding_m(const Problem& problem) {
    constexpr double kRounding_m =
        3.5e-18;  // half a unit in the last place of the 20 to 60 mm of the needles
    return 1e-15 + 4 * kRounding_m / problem.step_s * problem.duration_s;
}

TEST_P(HardReference, ExactToRounding) {
    ExactTissue tissue(problem().tissue);
    const Accuracy a = judge(problem(), solution_of(GetParam()), tissue);
    print("exact", problem(), a);
    EXPECT_FALSE(a.events_differ);
    ASSERT_GT(a.events, 0u);
    EXPECT_LE(a.position_m, std::min(rounding_m(problem()), 1e-13));
    EXPECT_EQ(tissue.unresolved_steps(), 0u);
    EXPECT_LE(a.event_time_s, 1e-13);
}

double fastest_m_per_s(const Problem& problem) {
    const std::vector<double> needle_m = problem.needle_samples_m();
    double fastest = 0;
    for (std::size_t i = 1; i < needle_m.size(); ++i) {
        fastest = std::max(fastest, std::abs(needle_m[i] - needle_m[i - 1]) / problem.step_s);
    }
    return fastest;
}

// A surface that is let go a step late has gone that step with the needle: h v, and for each of the two sides
// of a contact. Its next meeting comes later by as much again.
void expect_order_of_the_step(const Problem& problem, const Accuracy& a) {
    EXPECT_FALSE(a.events_differ);
    EXPECT_FALSE(a.diverged);
    EXPECT_LE(a.position_m, 2 * kStep_s * fastest_m_per_s(problem));
    EXPECT_LE(a.event_time_s, 2 * kStep_s);
}

TEST_P(HardReference, ImplicitMidpointWithinItsStep) {
    const Accuracy a = judged("implicit_midpoint");
    if (problem().name == "wall") {
        // Stable, but 712 Hz turn 4.5 rad in a step: the surface swings out of phase, as far as it swings.
        EXPECT_FALSE(a.events_differ);
        EXPECT_LE(a.position_m, 1e-3);
        EXPECT_GE(a.position_m, 2 * kStep_s * fastest_m_per_s(problem()));
        return;
    }
    expect_order_of_the_step(problem(), a);
}

// A solver that refuses throws an error.
TEST_P(HardReference, ExplicitRulesWithinTheirStepOrRefused) {
    const bool stiff = problem().name == "wall" || problem().name == "massless";
    for (const std::string_view solver : {"semi_implicit_euler", "rk4"}) {
        SCOPED_TRACE(solver);
        if (stiff) {
            EXPECT_THROW(judged(solver), Error);
        } else {
            expect_order_of_the_step(problem(), judged(solver));
        }
    }
}

}  // namespace
}  // namespace thimble
