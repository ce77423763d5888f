// A test that runs once for each solver, with what may be asked of it.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "slave_sim/solvers.hpp"
#include "tests/unit/slave_sim/phases.hpp"

namespace thimble {

class EverySolver : public testing::TestWithParam<std::string_view> {
  protected:
    // Of a stepped solver. It looks at its guards when a step is done, so what it reports comes late, by less
    // than this; `exact` is given the rounding of a time.
    static constexpr double kStep_s = 1e-3;

    bool exact() const { return GetParam() == "exact"; }
    double late_s() const { return exact() ? 0 : kStep_s; }
    std::unique_ptr<TissueSolver> make(const TissueParameters& parameters) const {
        return solver_maker({GetParam(), kStep_s})(parameters);
    }
    // No earlier than `truth_s`, and late by what the solver may be.
    void expect_time(double found_s, double truth_s, double rounding_s) const {
        EXPECT_GE(found_s, truth_s - rounding_s) << GetParam();
        EXPECT_LE(found_s, truth_s + late_s() + rounding_s) << GetParam();
    }
};

#define THIMBLE_EVERY_SOLVER(suite)                                           \
    INSTANTIATE_TEST_SUITE_P(Solvers, suite, testing::ValuesIn(kSolverNames), \
                             [](const auto& solver) { return std::string(solver.param); })

}  // namespace thimble
