// Properties of any needle in any scene, with any solver.
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "slave_sim/scene_file.hpp"
#include "tests/unit/slave_sim/phases.hpp"
#include "tests/unit/slave_sim/random_scene.hpp"

namespace thimble {
namespace {

// The elements of a scene, each of which is stepped every time: what a scene must amount to that lets most of
// them sleep.
class Sleepless {
  public:
    Sleepless(const SceneDeclaration& scene, const TissueMaker& make) {
        for (const ElementKind kind : {ElementKind::kTissue, ElementKind::kFixture}) {
            for (std::uint32_t i = 0; i < scene.elements.size(); ++i) {
                const ElementDeclaration& declared = scene.elements[i];
                if (declared.kind != kind) continue;
                members_.push_back({declared.make(make), i, kind});
            }
        }
    }
    void reset(const NeedleSample& needle) {
        for (Member& m : members_) {
            m.element->reset(m.kind == ElementKind::kTissue ? needle.position_m : needle.position_reading_m);
        }
        needle_ = needle;
    }
    void step(double start_s, double duration_s, const NeedleSample& to) {
        transitions_.clear();
        const double v = (to.position_m - needle_.position_m) / duration_s;
        for (Member& m : members_) {
            transitions_.of(m.index);
            const bool tissue = m.kind == ElementKind::kTissue;
            m.element->step({start_s, duration_s, tissue ? needle_.position_m : needle_.position_reading_m,
                             tissue ? to.position_m : to.position_reading_m, v},
                            transitions_);
        }
        needle_ = to;
    }
    double force_N(ElementKind kind) const {
        double sum_N = 0;
        for (const Member& m : members_) sum_N += m.kind == kind ? m.element->force_N() : 0;
        return sum_N;
    }
    struct Member {
        std::unique_ptr<Element> element;
        std::uint32_t index;
        ElementKind kind;
    };
    const std::vector<Member>& members() const { return members_; }
    const Transitions& transitions() const { return transitions_; }

  private:
    std::vector<Member> members_;
    Transitions transitions_{Transitions::kUnlimited};
    NeedleSample needle_;
};

// A random scene under way.
struct Insertion {
    std::string text = random_scene();
    SceneDeclaration declaration;
    RandomSolver solver;
    NeedleScene scene;
    Sleepless elements;
    double now_s = 0;

    Insertion()
        : declaration(read_scene(ConfigFile::parse(text, "random"), "random")),
          solver(random_solver(declaration)),
          scene(declaration, solver.make, Transitions::kUnlimited),
          elements(declaration, solver.make) {
        RC_TAG(solver.name);
        RC_LOG() << text;
        scene.reset({-0.02, -0.02});
        elements.reset({-0.02, -0.02});
    }
    void step(const RandomStep& step) {
        scene.clear_transitions();
        scene.step(now_s, step.duration_s, step.needle);
        elements.step(now_s, step.duration_s, step.needle);
        now_s += step.duration_s;
    }
};

TEST(SceneProperty, WhoSleepsMissesNothing) {
    EXPECT_TRUE(rc::check("scene and elements: the same bits", [] {
        Insertion run;
        for (const RandomStep& step : random_needle(run.declaration)) {
            run.step(step);
            RC_ASSERT(run.scene.force_tissue_N() == run.elements.force_N(ElementKind::kTissue));
            RC_ASSERT(run.scene.force_fixture_N() == run.elements.force_N(ElementKind::kFixture));
            const Transitions& seen = run.scene.transitions();
            const Transitions& truth = run.elements.transitions();
            RC_ASSERT(seen.size() == truth.size());
            for (std::size_t i = 0; i < truth.size(); ++i) {
                RC_ASSERT(seen[i].element == truth[i].element);
                RC_ASSERT(seen[i].phase == truth[i].phase);
                RC_ASSERT(seen[i].offset_s == truth[i].offset_s);
            }
        }
    }));
}

// `exact` locates its guards to rounding; the others obey them at the end of each of their steps, and so at
// each sample. Rounding is that of the terms a guard is made of.
void expect_guards(const TissueSolver& tissue, double needle_m) {
    const TissueParameters& p = tissue.parameters();
    const TissueState s = tissue.state();
    RC_ASSERT(std::isfinite(s.position_surface_m));
    RC_ASSERT(std::isfinite(s.velocity_surface_m_per_s));
    RC_ASSERT(std::isfinite(s.force_N));
    const double gap_m = needle_m - s.position_surface_m;
    const double rounding_m = 1e-14 * (std::abs(needle_m) + std::abs(s.position_surface_m) + 1e-2);
    if (s.phase == TissuePhase::kFree) {
        RC_ASSERT(gap_m <= rounding_m);
        RC_ASSERT(s.force_N == 0);
    } else if (s.phase == TissuePhase::kPenetrated) {
        RC_ASSERT(gap_m >= -rounding_m);
    } else {
        const double rounding_N = p.stiffness_N_per_m * rounding_m + 1e-14 * p.puncture_force_N +
                                  1e-14 * p.damping_Ns_per_m * std::abs(s.velocity_surface_m_per_s);
        RC_ASSERT(std::abs(gap_m) <= rounding_m);
        RC_ASSERT(-s.force_N >= -rounding_N);
        RC_ASSERT(-s.force_N <= p.puncture_force_N + rounding_N);
    }
}

// Also after a step whose transitions would cost too much to find.
TEST(SceneProperty, PhasesAgreeWithTheirGuardsAndNothingIsNaN) {
    EXPECT_TRUE(rc::check("guards", [] {
        Insertion run;
        for (const RandomStep& step : random_needle(run.declaration)) {
            run.step(step);
            RC_ASSERT(std::isfinite(run.scene.force_tissue_N()));
            RC_ASSERT(std::isfinite(run.scene.force_fixture_N()));
            for (const auto& member : run.elements.members()) {
                RC_ASSERT(std::isfinite(member.element->force_N()));
                const auto* tissue = dynamic_cast<const TissueSolver*>(member.element.get());
                if (tissue == nullptr) continue;
                expect_guards(*tissue, step.needle.position_m);
            }
        }
    }));
}

bool may_follow(std::string_view before, std::string_view after) {
    if (after == "contact") return before == "free";
    if (after == "penetrated") return before == "contact";
    if (after == "free") return before != "free";
    if (after == "touched") return before == "left";
    return after == "left" && before == "touched";
}

bool of_the_plane(std::string_view phase) {
    return phase == "removed" || phase == "placed" || phase == "moved";
}

TEST(SceneProperty, TransitionsFollowOneAnotherInTheOrderOfTimeAndOfTheAutomaton) {
    EXPECT_TRUE(rc::check("order", [] {
        Insertion run;
        std::vector<std::string_view> phase(run.declaration.elements.size());
        for (std::size_t i = 0; i < phase.size(); ++i) {
            phase[i] = run.declaration.elements[i].kind == ElementKind::kTissue ? "free" : "left";
        }
        std::size_t transitions = 0;
        for (const RandomStep& step : random_needle(run.declaration)) {
            run.step(step);
            std::vector<double> before_s(phase.size(), 0);
            for (const Transition& t : run.scene.transitions()) {
                RC_ASSERT(t.offset_s >= before_s[t.element]);
                RC_ASSERT(t.offset_s <= step.duration_s * (1 + 1e-15));
                before_s[t.element] = t.offset_s;
                if (of_the_plane(t.phase) || t.phase == "unresolved") continue;
                RC_ASSERT(may_follow(phase[t.element], t.phase));
                phase[t.element] = t.phase;
                ++transitions;
            }
        }
        RC_CLASSIFY(transitions > 10, "more than 10 transitions");
    }));
}

double half_swings(const TissueSolver& tissue, double duration_s) {
    const TissueParameters& p = tissue.parameters();
    return duration_s * std::sqrt(p.stiffness_N_per_m / p.mass_kg) / std::numbers::pi;
}

// A stepped solver looks at its guards once in a step, where at most two follow one another. An exact one goes
// through four for each half swing of its surface: let go, caught, pierced, come back.
double most_transitions(const TissueSolver& tissue, const RandomSolver& solver, double duration_s) {
    if (solver.name != "exact") return 2 * std::ceil(duration_s / solver.step_s);
    return 8 + 4 * half_swings(tissue, duration_s);
}

bool unresolved(const Transitions& transitions, std::uint32_t element) {
    for (const Transition& t : transitions) {
        if (t.element == element && t.phase == "unresolved") return true;
    }
    return false;
}

TEST(SceneProperty, NoChatterWithoutProgress) {
    EXPECT_TRUE(rc::check("transitions of a step", [] {
        Insertion run;
        for (const RandomStep& step : random_needle(run.declaration)) {
            run.step(step);
            std::vector<double> count(run.declaration.elements.size(), 0);
            for (const Transition& t : run.scene.transitions()) {
                ++count[t.element];
            }
            for (const auto& member : run.elements.members()) {
                const auto* tissue = dynamic_cast<const TissueSolver*>(member.element.get());
                // A fixture is touched, left and changed three times at most.
                const double most =
                    tissue == nullptr ? 12 : most_transitions(*tissue, run.solver, step.duration_s);
                RC_ASSERT(count[member.index] <= most);
                // Given up only where there are more swings than one looks at.
                if (!unresolved(run.scene.transitions(), member.index)) continue;
                RC_ASSERT(tissue != nullptr && run.solver.name == "exact");
                RC_ASSERT(half_swings(*tissue, step.duration_s) > 100);
            }
        }
    }));
}

}  // namespace
}  // namespace thimble
