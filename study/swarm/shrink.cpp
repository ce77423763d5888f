#include <utility>

#include "study/swarm/swarm.hpp"

namespace thimble {
namespace {

class Shrinker {
  public:
    Shrinker(SwarmCase& one, Rule broken, const BreakForce& break_force)
        : case_(one), broken_(broken), break_force_(break_force) {}

    // Whether anything could go.
    bool pass() {
        bool less = without_one(&SwarmCase::faults);
        less = without_one(&SwarmCase::keys) || less;
        if (case_.trials > 1) less = try_with([](SwarmCase& smaller) { smaller.trials = 1; }) || less;
        if (case_.sealed) less = try_with([](SwarmCase& smaller) { smaller.sealed = false; }) || less;
        return less;
    }

  private:
    // One after the other. Keys that need a removed one go with it.
    template <class List>
    bool without_one(List SwarmCase::*list) {
        bool less = false;
        for (std::size_t i = (case_.*list).size(); i-- > 0;) {
            if (i >= (case_.*list).size()) continue;  // gone with another
            const auto remove = [&](SwarmCase& smaller) {
                auto& items = smaller.*list;
                items.erase(items.begin() + static_cast<std::ptrdiff_t>(i));
            };
            less = try_with(remove) || less;
        }
        return less;
    }

    template <class Change>
    bool try_with(const Change& change) {
        SwarmCase smaller = case_;
        change(smaller);
        const SwarmOutcome outcome = run_case(smaller, break_force_);
        if (!outcome.violation || outcome.violation->rule != broken_) return false;
        case_ = std::move(smaller);
        return true;
    }

    SwarmCase& case_;
    Rule broken_;
    const BreakForce& break_force_;
};

}  // namespace

SwarmCase shrink(SwarmCase one, Rule broken, const BreakForce& break_force) {
    Shrinker shrinker(one, broken, break_force);
    while (shrinker.pass()) {
    }
    return one;
}

}  // namespace thimble
