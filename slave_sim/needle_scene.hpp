// Everything the needle can meet, and the forces it gets from it. Only declared elements are computed, and an element that rests away from the needle costs nothing.
#pragma once

#include <string>
#include <vector>

#include "slave_sim/element_group.hpp"
#include "slave_sim/elements/forbidden_region.hpp"
#include "slave_sim/scene_declaration.hpp"

namespace thimble {

// Where the needle is at the end of a step.
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
