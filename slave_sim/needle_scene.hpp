// The elements that the needle can meet, and the forces on it. An element that rests away from the needle costs
// nothing.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "slave_sim/elements/forbidden_region.hpp"
#include "slave_sim/scene_declaration.hpp"

namespace thimble {

// Elements that follow the same needle position. Only those near the needle are stepped; the others rest.
class ElementGroup {
  public:
    void add(std::unique_ptr<Element> element, std::uint32_t index);
    void reset(double position_needle_m);

    // The cost does not depend on the number of resting elements.
    void step(const NeedleStep& step, Transitions& transitions) {
        if (step.to_m > wake_beyond_m_) review(step.to_m);
        if (!awake_.empty()) step_awake(step, transitions);
    }
    // Sum over the active elements; a resting one gives no force.
    double force_N() const {
        double sum_N = 0;
        for (const Member* member : awake_) sum_N += member->element->force_N();
        return sum_N;
    }
    // Decides anew which elements rest with the needle here. Call it after an element was changed from outside.
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

// Needle position at the end of a step, m along z.
struct NeedleSample {
    double position_m = 0;          // what tissue follows: smooth, its slope is the estimated velocity
    double position_reading_m = 0;  // what fixtures follow: the encoder's
};

class NeedleScene {
  public:
    // Throws Error (usage) if the solver cannot step a declared tissue.
    NeedleScene(const SceneDeclaration& declaration, const TissueMaker& make_tissue,
                std::size_t most_transitions = 16);
    NeedleScene(NeedleScene&&) = default;
    NeedleScene& operator=(NeedleScene&&) = default;

    // The beginning of a trial: tissue at rest, fixtures where they were placed last.
    void reset(const NeedleSample& needle);
    // From the last needle to this one on a straight line. start_s on the scene's clock; duration_s >= 0, and
    // without time nothing moves.
    void step(double start_s, double duration_s, const NeedleSample& needle);

    double force_tissue_N() const { return tissue_.force_N(); }
    double force_fixture_N() const { return fixtures_.force_N(); }
    const NeedleSample& needle() const { return needle_; }

    // The surface that lies outermost, null in a scene without tissue.
    const TissueSolver* surface() const { return surface_; }
    // The first forbidden region, the one a trial's orders speak of; null without.
    const ForbiddenRegion* fixture() const { return fixture_; }
    void place_fixture(double position_m, bool present);

    // Since the last clear_transitions(); offsets count from the start of each one's step.
    const Transitions& transitions() const { return transitions_; }
    void clear_transitions() { transitions_.clear(); }
    const std::string& element_name(std::uint32_t element) const { return names_[element]; }
    std::size_t awake() const { return tissue_.awake() + fixtures_.awake(); }

  private:
    void add(const ElementDeclaration& declared, const TissueMaker& make_tissue);

    ElementGroup tissue_;
    ElementGroup fixtures_;
    std::vector<std::string> names_;
    Transitions transitions_;
    NeedleSample needle_;
    const TissueSolver* surface_ = nullptr;
    ForbiddenRegion* fixture_ = nullptr;
};

}  // namespace thimble
