// Elements that follow the same needle; steps those that the needle concerns and lets the others sleep.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "slave_sim/element.hpp"

namespace thimble {

class ElementGroup {
  public:
    void add(std::unique_ptr<Element> element, std::uint32_t index);
    void reset(double position_needle_m);

    // The cost does not depend on how many elements sleep.
    void step(const NeedleStep& step, Transitions& transitions) {
        if (step.to_m > wake_beyond_m_) review(step.to_m);
        if (!awake_.empty()) step_awake(step, transitions);
    }
    // Sum over the elements that are awake; one that sleeps does not push.
    double force_N() const {
        double sum_N = 0;
        for (const Member* member : awake_) sum_N += member->element->force_N();
        return sum_N;
    }
    // Finds the elements that rest with the needle here. Call it after an element was changed from outside.
    void review(double position_needle_m);

    std::size_t awake() const { return awake_.size(); }

  private:
    struct Member {
        std::unique_ptr<Element> element;
        std::uint32_t index;
        double rests_above_m;  // as long as it sleeps
    };

    void step_awake(const NeedleStep& step, Transitions& transitions);

    std::vector<Member> members_;
    std::vector<const Member*> awake_;  // in the order of members_
    double wake_beyond_m_ = std::numeric_limits<double>::infinity();
};

}  // namespace thimble
