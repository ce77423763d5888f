#include "slave_sim/element_group.hpp"

#include <algorithm>

namespace thimble {

void ElementGroup::add(std::unique_ptr<Element> element, std::uint32_t index) {
    members_.push_back({std::move(element), index, 0});
    awake_.reserve(members_.capacity());
}

void ElementGroup::reset(double position_needle_m) {
    for (Member& member : members_) member.element->reset(position_needle_m);
    review(position_needle_m);
}

// Rare: only where an element falls asleep or wakes.
void ElementGroup::review(double position_needle_m) {
    awake_.clear();
    wake_beyond_m_ = std::numeric_limits<double>::infinity();
    for (Member& member : members_) {
        member.rests_above_m = member.element->rests_above_m();
        if (position_needle_m > member.rests_above_m) {
            awake_.push_back(&member);
        } else {
            wake_beyond_m_ = std::min(wake_beyond_m_, member.rests_above_m);
        }
    }
}

void ElementGroup::step_awake(const NeedleStep& step, Transitions& transitions) {
    bool somebody_rests = false;
    for (const Member* member : awake_) {
        transitions.of(member->index);
        member->element->step(step, transitions);
        somebody_rests = somebody_rests || step.to_m <= member->element->rests_above_m();
    }
    if (somebody_rests) review(step.to_m);
}

}  // namespace thimble
