// Properties of any needle in any scene, with any solver.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "common/error.hpp"
#include "slave_sim/needle_scene.hpp"
#include "slave_sim/scene_file.hpp"
#include "slave_sim/solvers.hpp"
#include "tests/unit/slave_sim/random_values.hpp"

namespace thimble {
namespace {

bool chance(double probability) { return between(0, 1) < probability; }

// One in three is hard: nearly massless, heavy or stiff, a drag of nothing or much.
std::string random_tissue_keys() {
    const bool hard = chance(0.3);
    const double mass_kg = hard ? decade(-12, 6) : decade(-2, 1);
    const double stiffness = chance(0.1) ? 0 : hard ? decade(-3, 6) : decade(-1, 2);
    const double damping = chance(0.1) ? 0 : hard ? decade(-3, 3) : decade(-1, 1);
    const double drag = chance(0.1) ? 0 : hard ? decade(-6, 2) : decade(-2, 0.5);
    return fmt::format(
        "mass_kg = {:e}\nstiffness_N_per_m = {:e}\ndamping_Ns_per_m = {:e}\ndrag_Ns_per_m = {:e}\n"
        "puncture_force_N = {:e}\nrest_position_m = {:.17f}\n",
        mass_kg, stiffness, damping, drag, decade(-3, 1), between(0, 0.08));
}

std::string random_event() {
    const char* trigger = chance(0.5) ? "time_s" : "after_contact_s";
    std::string text = fmt::format("[[fixture.event]]\n{} = {:e}\n", trigger, decade(-3, 1));
    if (chance(0.5)) text += fmt::format("position_m = {:.17f}\n", between(0, 0.1));
    return text;
}

std::string random_fixture() {
    std::string text =
        fmt::format("[[fixture]]\nstiffness_N_per_m = {:e}\ndamping_Ns_per_m = {:e}\nposition_m = {:.17f}\n",
                    decade(2, 9), chance(0.5) ? 0 : decade(-1, 3), between(0, 0.1));
    for (double events = between(-1, 3.99); events >= 1; --events) text += random_event();
    return text;
}

struct RandomSolver {
    std::string name;
    double step_s;
    TissueMaker make;
};

struct RandomStep {
    double duration_s;
    NeedleSample needle;
};

// The text of a scene file: up to four layers and a vessel, fixtures that change, guidance.
std::string random_scene() {
    std::string text;
    for (double layers = between(0, 4.99); layers >= 1; --layers)
        text += "[[tissue]]\n" + random_tissue_keys();
    if (chance(0.3)) {
        text += fmt::format("[vessel]\ndiameter_m = {:.17f}\n", between(0, 0.01)) + random_tissue_keys();
    }
    for (double fixtures = between(0, 2.99); fixtures >= 1; --fixtures) text += random_fixture();
    if (chance(0.3)) {
        text += fmt::format("[guidance]\nstiffness_N_per_m = {:e}\ndamping_Ns_per_m = {:e}\n", decade(0, 4),
                            chance(0.5) ? 0 : decade(-1, 2));
    }
    return text;
}

// One that can step every tissue of the scene; hard tissue leaves two.
RandomSolver random_solver(const SceneDeclaration& scene) {
    const double step_s = decade(-3.3, -1);
    const auto index = static_cast<std::size_t>(between(0, 3.999));
    for (const std::string_view name : {kSolverNames[index], kSolverNames[3]}) {
        const TissueMaker make = solver_maker({name, step_s});
        try {
            NeedleScene(scene, make);
            return {std::string(name), step_s, make};
        } catch (const Error&) {
            // An explicit rule that would be unstable: the implicit one never is.
        }
    }
    RC_FAIL("implicit_midpoint refused a tissue");
}

// Strokes, holds and tremor about the elements, in steps from 1 us to 2 s; some needles are quantised, and many
// stand on a surface to the last bit.
std::vector<RandomStep> random_needle(const SceneDeclaration& scene) {
    const double quantum_m = chance(0.3) ? 3e-5 : 0;
    std::vector<RandomStep> steps;
    double needle_m = between(-0.02, 0.02);
    for (int i = 0; i < 60; ++i) {
        const double kind = between(0, 1);
        if (kind < 0.4) needle_m += between(-0.01, 0.01);
        if (kind > 0.4 && kind < 0.5) needle_m += between(-1e-6, 1e-6);
        if (kind > 0.7) needle_m = between(-0.02, 0.12);
        if (quantum_m > 0) needle_m = quantum_m * std::round(needle_m / quantum_m);
        if (kind > 0.9 && !scene.elements.empty()) {
            const double place = between(0, static_cast<double>(scene.elements.size()) - 1e-9);
            needle_m = scene.elements[static_cast<std::size_t>(place)].position_m;
        }
        const double reading_m = chance(0.7) ? needle_m : needle_m + between(-1e-4, 1e-4);
        steps.push_back({decade(-6, 0.3), {needle_m, reading_m}});
    }
    return steps;
}

// The elements of a scene, all stepped every time: the reference for a scene whose elements mostly rest.
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

void expect_same_bits(const Insertion& run) {
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

// `phase` is that of each element so far.
void expect_order(const Insertion& run, double duration_s, std::vector<std::string_view>& phase) {
    std::vector<double> before_s(phase.size(), 0);
    for (const Transition& t : run.scene.transitions()) {
        RC_ASSERT(t.offset_s >= before_s[t.element]);
        RC_ASSERT(t.offset_s <= duration_s * (1 + 1e-15));
        before_s[t.element] = t.offset_s;
        if (of_the_plane(t.phase) || t.phase == "unresolved") continue;
        RC_ASSERT(may_follow(phase[t.element], t.phase));
        phase[t.element] = t.phase;
    }
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

void expect_no_chatter(const Insertion& run, const Sleepless::Member& member, double duration_s) {
    const Transitions& transitions = run.scene.transitions();
    const auto count = std::count_if(transitions.begin(), transitions.end(),
                                     [&](const Transition& t) { return t.element == member.index; });
    const auto* tissue = dynamic_cast<const TissueSolver*>(member.element.get());
    // A fixture is touched, left and changed three times at most.
    const double most = tissue == nullptr ? 12 : most_transitions(*tissue, run.solver, duration_s);
    RC_ASSERT(static_cast<double>(count) <= most);
    // Given up only where there are more swings than one looks at.
    if (!unresolved(transitions, member.index)) return;
    RC_ASSERT(tissue != nullptr && run.solver.name == "exact");
    RC_ASSERT(half_swings(*tissue, duration_s) > 100);
}

// Who sleeps misses nothing; phases agree with their guards, also after a step whose transitions would cost too
// much to find; transitions follow one another in the order of time and of the automaton, and not without end.
TEST(SceneProperty, HoldsForAnyNeedleInAnyScene) {
    EXPECT_TRUE(rc::check("scene", [] {
        Insertion run;
        std::vector<std::string_view> phase;
        for (const ElementDeclaration& element : run.declaration.elements)
            phase.push_back(element.kind == ElementKind::kTissue ? "free" : "left");
        std::size_t transitions = 0;
        for (const RandomStep& step : random_needle(run.declaration)) {
            run.step(step);
            expect_same_bits(run);
            expect_order(run, step.duration_s, phase);
            for (const auto& member : run.elements.members()) {
                RC_ASSERT(std::isfinite(member.element->force_N()));
                expect_no_chatter(run, member, step.duration_s);
                const auto* tissue = dynamic_cast<const TissueSolver*>(member.element.get());
                if (tissue != nullptr) expect_guards(*tissue, step.needle.position_m);
            }
            transitions += run.scene.transitions().size();
        }
        RC_CLASSIFY(transitions > 10, "more than 10 transitions");
    }));
}

}  // namespace
}  // namespace thimble
