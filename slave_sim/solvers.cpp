#include "slave_sim/solvers.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"
#include "slave_sim/exact_tissue.hpp"
#include "slave_sim/stepped_tissue.hpp"

namespace thimble {

namespace {

template <class Rule>
TissueMaker stepped(double longest_step_s) {
    return [longest_step_s](const TissueParameters& parameters) {
        return std::make_unique<SteppedTissue<Rule>>(parameters, longest_step_s);
    };
}

}  // namespace

TissueMaker solver_maker(const SolverChoice& choice) {
    if (choice.name == "exact") {
        return [](const TissueParameters& parameters) { return std::make_unique<ExactTissue>(parameters); };
    }
    if (choice.name == SemiImplicitEuler::kName) return stepped<SemiImplicitEuler>(choice.longest_step_s);
    if (choice.name == RungeKutta4::kName) return stepped<RungeKutta4>(choice.longest_step_s);
    if (choice.name == ImplicitMidpoint::kName) return stepped<ImplicitMidpoint>(choice.longest_step_s);
    throw Error(ExitCode::kUsage, "there is no solver \"{}\": take one of {}", choice.name,
                fmt::join(kSolverNames, ", "));
}

}  // namespace thimble
