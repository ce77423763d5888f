// Several elements at once: who is stepped, who sleeps, and what the needle feels.
#include "slave_sim/needle_scene.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "slave_sim/scene_file.hpp"
#include "slave_sim/solvers.hpp"

namespace thimble {
namespace {

constexpr double kStep_s = 1e-3;

SceneDeclaration scene_of(const char* text) { return read_scene(ConfigFile::parse(text, "test"), "test"); }

NeedleScene build(const SceneDeclaration& declaration) { return {declaration, solver_maker({})}; }

struct SceneWalker {
    NeedleScene scene;
    double time_s = 0;

    explicit SceneWalker(const SceneDeclaration& declaration, double start_m = 0)
        : scene(build(declaration)) {
        scene.reset({start_m, start_m});
    }
    void to(double needle_m, double duration_s = kStep_s) {
        scene.step(time_s, duration_s, {needle_m, needle_m});
        time_s += duration_s;
    }
    void stroke(double to_m, int steps) {
        const double from_m = scene.needle().position_m;
        for (int i = 1; i <= steps; ++i) to(from_m + (to_m - from_m) * i / steps);
    }
};

// Counts how often it is asked for anything; rests while the needle is at or above 50 mm.
struct Counter {
    int steps = 0;
};
class CountingElement final : public Element {
  public:
    explicit CountingElement(Counter& counter) : counter_(counter) {}
    void reset(double) override {}
    void step(const NeedleStep& step, Transitions&) override {
        ++counter_.steps;
        end_m_ = step.to_m;
    }
    double force_N() const override { return -1; }
    double rests_above_m() const override { return 0.05; }

  private:
    Counter& counter_;
    double end_m_ = 0;
};

SceneDeclaration counting(Counter& counter, ElementKind kind) {
    SceneDeclaration scene;
    scene.elements.push_back({"counter", kind, 0.05, [&counter](const TissueMaker&) {
                                  return std::make_unique<CountingElement>(counter);
                              }});
    return scene;
}

TEST(NeedleScene, AnElementIsNotSteppedWhileItRests) {
    for (const ElementKind kind : {ElementKind::kTissue, ElementKind::kFixture}) {
        Counter counter;
        SceneWalker w(counting(counter, kind));
        w.stroke(0.05, 100);  // up to where it rests, not beyond
        EXPECT_EQ(counter.steps, 0);
        EXPECT_EQ(w.scene.awake(), 0u);
        EXPECT_EQ(w.scene.force_tissue_N() + w.scene.force_fixture_N(), 0);
        w.to(0.051);
        EXPECT_EQ(counter.steps, 1);
        EXPECT_EQ(w.scene.force_tissue_N() + w.scene.force_fixture_N(), -1);
        w.to(0.049);  // the step that leaves
        EXPECT_EQ(counter.steps, 2);
        w.stroke(0.02, 50);
        EXPECT_EQ(counter.steps, 2);
        EXPECT_EQ(w.scene.awake(), 0u);
    }
}

TEST(NeedleScene, LayersWakeOneAfterTheOther) {
    SceneWalker w(load_scene("layers.toml"));
    EXPECT_EQ(w.scene.awake(), 0u);
    w.stroke(0.0255, 100);
    EXPECT_EQ(w.scene.awake(), 1u);  // skin
    w.stroke(0.049, 100);
    EXPECT_EQ(w.scene.awake(), 2u);  // and fat
    w.stroke(0.06, 100);
    EXPECT_EQ(w.scene.awake(), 3u);  // and muscle
    w.stroke(0.11, 100);
    EXPECT_EQ(w.scene.awake(), 4u);  // and the fixture
    w.stroke(0.0, 100);
    w.to(0.0, 60);  // everything comes to rest
    w.to(0.0, 60);
    EXPECT_EQ(w.scene.awake(), 0u);
    EXPECT_EQ(w.scene.surface()->state().position_surface_m, 0.020);
    EXPECT_EQ(w.scene.surface()->state().velocity_surface_m_per_s, 0);
}

TEST(NeedleScene, FixturesFollowTheReadingAndTissueTheEstimate) {
    NeedleScene scene = build(scene_of("[tissue]\n[fixture]\n"));
    scene.reset({0.0, 0.0});
    scene.step(0, kStep_s, {0.019, 0.124});
    EXPECT_EQ(scene.surface()->state().phase, TissuePhase::kFree);
    EXPECT_NEAR(scene.force_fixture_N(), -3, 1e-9);
    scene.reset({0.019, 0.125});
    EXPECT_NEAR(scene.force_fixture_N(), -6, 1e-9) << "from the first instant on";
}

TEST(NeedleScene, WithoutTimeOrElementsNothingMoves) {
    SceneWalker w(scene_of("[tissue]\n[fixture]\n"));
    w.stroke(0.05, 100);
    const TissueState before = w.scene.surface()->state();
    w.to(0.2, 0);
    EXPECT_EQ(w.scene.needle().position_m, 0.05);
    EXPECT_EQ(w.scene.surface()->state().position_surface_m, before.position_surface_m);
    EXPECT_EQ(w.scene.force_fixture_N(), 0);
    SceneWalker none(SceneDeclaration{});
    none.stroke(0.2, 100);
    EXPECT_EQ(none.scene.surface(), nullptr);
    EXPECT_EQ(none.scene.fixture(), nullptr);
    EXPECT_EQ(none.scene.force_tissue_N() + none.scene.force_fixture_N(), 0);
    EXPECT_EQ(none.scene.transitions().size(), 0u);
}

TEST(NeedleScene, AFixturePlacedOnTheNeedleIsFeltAtOnce) {
    SceneWalker w(scene_of("[tissue]\n[fixture]\n"));
    w.stroke(0.1, 100);
    EXPECT_EQ(w.scene.force_fixture_N(), 0);
    w.scene.place_fixture(0.099, true);
    EXPECT_NEAR(w.scene.force_fixture_N(), -3, 1e-9);
    w.scene.place_fixture(0.099, false);
    EXPECT_EQ(w.scene.force_fixture_N(), 0);
    w.to(0.15);
    EXPECT_EQ(w.scene.force_fixture_N(), 0);
}

TEST(NeedleScene, AVesselResistsAndGivesWayTwice) {
    SceneWalker w(load_scene("vessel.toml"));
    std::vector<std::string> events;
    double strongest_N = 0;
    for (int i = 1; i <= 5000; ++i) {
        w.scene.clear_transitions();
        w.to(0.075 * i / 5000);  // 15 mm/s
        for (const Transition& t : w.scene.transitions()) {
            events.push_back(w.scene.element_name(t.element) + " " + std::string(t.phase));
        }
        strongest_N = std::max(strongest_N, -w.scene.force_tissue_N());
    }
    const std::vector<std::string> expected{"tissue contact",      "tissue penetrated",
                                            "vessel.near contact", "vessel.near penetrated",
                                            "vessel.far contact",  "vessel.far penetrated"};
    EXPECT_EQ(events, expected);
    EXPECT_GT(strongest_N, 0.5);
}

TEST(Guidance, DrawsFromBothSidesAndDamps) {
    SceneWalker w(
        scene_of("[guidance]\nstiffness_N_per_m = 10.0\ndamping_Ns_per_m = 2.0\nposition_m = 0.1\n"), 0.05);
    EXPECT_NEAR(w.scene.force_fixture_N(), 0.5, 1e-12);  // pulled in
    w.to(0.12, 1.0);
    EXPECT_NEAR(w.scene.force_fixture_N(), -10 * 0.02 - 2 * 0.07, 1e-12);
    w.to(0.12, 1.0);
    EXPECT_NEAR(w.scene.force_fixture_N(), -0.2, 1e-12);
}

}  // namespace
}  // namespace thimble
