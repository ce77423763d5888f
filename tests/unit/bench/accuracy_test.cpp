// The ruler of thimble-bench work-precision, and what it says of each solver where no clock is asked.
#include "bench/accuracy.hpp"

#include <cmath>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "bench/peers/cvode_tissue.hpp"
#include "bench/peers/odeint_tissue.hpp"
#include "slave_sim/exact_tissue.hpp"
#include "slave_sim/stepped_tissue.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

Accuracy accuracy_of(const Problem& problem, TissueSolver& solver) {
    return judge(problem, solve_reference(problem), solver);
}

// A solver that is wrong by a known amount, to see that the ruler finds it.
class Displaced final : public TissueSolver {
  public:
    Displaced(const TissueParameters& parameters, double position_error_m, double event_error_s)
        : TissueSolver(parameters),
          true_(parameters),
          position_error_m_(position_error_m),
          event_error_s_(event_error_s) {}

  protected:
    void restart() override { true_.reset(parameters().rest_position_m + needle_m_); }
    void move(double duration_s, double needle_end_m, Transitions& transitions) override {
        Transitions found;
        true_.advance(duration_s, parameters().rest_position_m + needle_end_m, found);
        for (const Transition& t : found) transitions.push(t.offset_s + event_error_s_, t.phase);
        phase_ = true_.state().phase;
        surface_m_ = true_.state().position_surface_m - parameters().rest_position_m + position_error_m_;
        velocity_surface_m_per_s_ = true_.state().velocity_surface_m_per_s;
    }

  private:
    ExactTissue true_;
    double position_error_m_, event_error_s_;
};

TEST(Accuracy, FindsAKnownError) {
    const Problem& problem = problem_named("insert_300mm_s");
    Displaced solver(problem.tissue, 1e-6, 3e-9);
    const Accuracy found = accuracy_of(problem, solver);
    EXPECT_NEAR(found.position_m, 1e-6, 1e-12);
    EXPECT_NEAR(found.event_time_s, 3e-9, 1e-14);
    EXPECT_EQ(found.events, 3u);
    EXPECT_FALSE(found.events_differ);
    EXPECT_FALSE(found.diverged);
}

TEST(Accuracy, ASolverThatRunsAwayIsSaidToDiverge) {
    const Problem& problem = problem_named("insert_300mm_s");
    Displaced solver(problem.tissue, 2, 0);
    EXPECT_TRUE(accuracy_of(problem, solver).diverged);
    Displaced lost(problem.tissue, std::nan(""), 0);
    EXPECT_TRUE(accuracy_of(problem, lost).diverged);
}

// A tenth of the step is a tenth of the error: all three are of order 1 across transitions.
template <class Rule>
void expect_first_order(std::string_view name) {
    const Problem& problem = problem_named(name);
    SteppedTissue<Rule> coarse(problem.tissue, 1e-4);
    SteppedTissue<Rule> fine(problem.tissue, 1e-5);
    const double ratio = accuracy_of(problem, coarse).position_m / accuracy_of(problem, fine).position_m;
    EXPECT_GT(ratio, 5) << Rule::kName;
    EXPECT_LT(ratio, 25) << Rule::kName;
}

TEST(PeerAccuracy, SteppedSolversAreOfFirstOrderAcrossTransitions) {
    expect_first_order<SemiImplicitEuler>("insert_300mm_s");
    expect_first_order<RungeKutta4>("insert_300mm_s");
    expect_first_order<ImplicitMidpoint>("insert_300mm_s");
}

// The peers are taken seriously: with a small tolerance they reach the reference.
TEST(PeerAccuracy, OdeintConvergesToTheReference) {
    const Problem& problem = problem_named("underdamped");
    OdeintTissue solver(problem.tissue, 1e-12);
    const Accuracy found = accuracy_of(problem, solver);
    EXPECT_LT(found.position_m, 1e-11);
    EXPECT_LT(found.event_time_s, 1e-10);
}

TEST(PeerAccuracy, CvodeConvergesToTheReference) {
    const Problem& problem = problem_named("underdamped");
    for (const CvodeMethod method : {CvodeMethod::kAdams, CvodeMethod::kBdf}) {
        CvodeTissue loose(problem.tissue, 1e-8, method, CvodeJump::kRestart);
        CvodeTissue tight(problem.tissue, 1e-12, method, CvodeJump::kRestart);
        const Accuracy found = accuracy_of(problem, tight);
        EXPECT_LT(found.position_m, 1e-9);
        EXPECT_LT(found.position_m, 1e-2 * accuracy_of(problem, loose).position_m);
        EXPECT_LT(found.event_time_s, 1e-8);
    }
}

TEST(PeerAccuracy, ATissueThatIsTooStiffIsGivenUpNotIntegratedForHours) {
    const Problem& problem = problem_named("massless");
    OdeintTissue solver(problem.tissue, 1e-9);
    EXPECT_THROW(accuracy_of(problem, solver), std::exception);
}

TEST(Problems, HaveNamesOfTheirOwnAndAnUnknownOneListsThem) {
    std::set<std::string_view> names;
    for (const Problem& problem : problems()) EXPECT_TRUE(names.insert(problem.name).second) << problem.name;
    EXPECT_NE(refusal([] { problem_named("soup"); }, ExitCode::kUsage).find("insert_100mm_s"),
              std::string::npos);
}

}  // namespace
}  // namespace thimble
