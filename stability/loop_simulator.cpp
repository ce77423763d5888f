#include "stability/loop_simulator.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "stability/circle_count.hpp"

namespace thimble {
namespace {

const HeldMass& checked_hand(const LoopConditions& conditions) {
    whole_steps(conditions.loop);  // throws where it is no loop
    if (conditions.friction_N >= 0 && std::isfinite(conditions.friction_N)) return conditions.loop.hand;
    throw Error(ExitCode::kUsage, "stability: friction must be finite and 0 N or more");
}

}  // namespace

LoopSimulator::LoopSimulator(const LoopConditions& conditions, double position_m, double velocity_m_per_s)
    : conditions_(conditions), hand_(checked_hand(conditions), position_m, velocity_m_per_s) {
    hand_.rub(conditions.friction_N);
    const WholeSteps delay = whole_steps(conditions.loop);
    const double rest_s = to_double(delay.rest_s);
    early_ = hand_.propagator(rest_s);
    late_ = hand_.propagator(conditions.loop.step_s - rest_s);
    under_way_.assign(static_cast<std::size_t>(delay.count) + 1, 0.0);
}

double LoopSimulator::sampled_m() const {
    const double step_m = conditions_.encoder_step_m;
    return step_m > 0 ? step_m * std::round(position_m() / step_m) : position_m();
}

void LoopSimulator::step() {
    double force_N = conditions_.loop.stiffness_N_per_m * sampled_m();
    if (conditions_.one_sided) force_N = std::max(force_N, 0.0);
    if (conditions_.force_limit_N > 0)
        force_N = std::clamp(force_N, -conditions_.force_limit_N, conditions_.force_limit_N);
    // One more place than whole steps: what is overwritten last is what the hand still feels until the next arrives.
    const std::size_t size = under_way_.size();
    const double felt_N = under_way_[next_];
    under_way_[next_] = force_N;
    next_ = next_ + 1 == size ? 0 : next_ + 1;
    if (early_.duration_s > 0) move(early_, felt_N);
    move(late_, under_way_[next_]);
}

void LoopSimulator::move(const Propagator& propagator, double force_N) {
    const double from_m = position_m();
    hand_.advance(propagator, conditions_.press_N - force_N);
    energy_J_ += force_N * (position_m() - from_m);
}

}  // namespace thimble
