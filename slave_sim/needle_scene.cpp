#include "slave_sim/needle_scene.hpp"

namespace thimble {

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
