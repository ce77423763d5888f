#include "slave_sim/needle_scene.hpp"

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

// Rare: called only where an element begins or ceases to rest.
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
    bool any_rests = false;
    for (const Member* member : awake_) {
        transitions.of(member->index);
        member->element->step(step, transitions);
        any_rests = any_rests || step.to_m <= member->element->rests_above_m();
    }
    if (any_rests) review(step.to_m);
}

NeedleScene::NeedleScene(const SceneDeclaration& declaration, const TissueMaker& make_tissue,
                         std::size_t most_transitions)
    : transitions_(most_transitions) {
    for (const ElementDeclaration& declared : declaration.elements) add(declared, make_tissue);
    reset({});
}

void NeedleScene::add(const ElementDeclaration& declared, const TissueMaker& make_tissue) {
    std::unique_ptr<Element> element = declared.make(make_tissue);
    if (const auto* surface = dynamic_cast<const TissueSolver*>(element.get())) {
        const auto depth_m = [](const TissueSolver* s) { return s->parameters().rest_position_m; };
        if (surface_ == nullptr || depth_m(surface) < depth_m(surface_)) surface_ = surface;
    }
    if (fixture_ == nullptr) fixture_ = dynamic_cast<ForbiddenRegion*>(element.get());
    ElementGroup& group = declared.kind == ElementKind::kTissue ? tissue_ : fixtures_;
    group.add(std::move(element), static_cast<std::uint32_t>(names_.size()));
    names_.push_back(declared.name);
}

void NeedleScene::reset(const NeedleSample& needle) {
    tissue_.reset(needle.position_m);
    fixtures_.reset(needle.position_reading_m);
    needle_ = needle;
}

void NeedleScene::step(double start_s, double duration_s, const NeedleSample& needle) {
    if (duration_s <= 0) return;
    const double velocity_m_per_s = (needle.position_m - needle_.position_m) / duration_s;
    tissue_.step({start_s, duration_s, needle_.position_m, needle.position_m, velocity_m_per_s},
                 transitions_);
    fixtures_.step(
        {start_s, duration_s, needle_.position_reading_m, needle.position_reading_m, velocity_m_per_s},
        transitions_);
    needle_ = needle;
}

void NeedleScene::place_fixture(double position_m, bool present) {
    if (fixture_ == nullptr) return;
    fixture_->place(position_m, present, needle_.position_reading_m);
    fixtures_.review(needle_.position_reading_m);
}

}  // namespace thimble
