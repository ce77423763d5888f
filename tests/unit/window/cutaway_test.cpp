#include "visual_node/window/cutaway.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "visual_node/visual_node.hpp"

namespace thimble {
namespace {

constexpr Rect kArea{0, 0, 800, 600};

Scene scene_with(double needle_m, Modality modality = Modality::kHF) {
    Scene scene;
    scene.position_surface_m = scene.position_surface_rest_m = 0.02;
    scene.cut_away =
        CutAway{needle_m, 0.12, -1, needle_m > 0.12 ? -3.0 : 0, std::nullopt, TissuePhase::kPenetrated,
                modality, true};
    return scene;
}

std::vector<std::string> texts(const Scene& scene) {
    std::vector<std::string> all;
    for (const CutawayLabel& label : cutaway_labels(scene, plan_cutaway(kArea))) all.push_back(label.text);
    return all;
}

TEST(Cutaway, AMillimetreIsAsLongInEachDepth) {
    const CutawayPlan plan = plan_cutaway(kArea);
    EXPECT_NEAR(plan.y(kCutawayTop_m), 0, 1e-9);
    EXPECT_NEAR(plan.y(kCutawayBottom_m), 600, 1e-9);
    EXPECT_NEAR(plan.y(0.1) - plan.y(0.09), 0.01 * plan.per_m, 1e-9);
}

TEST(Cutaway, ForceAndDepthStandBesideTheNeedle) {
    EXPECT_THAT(texts(scene_with(0.122)),
                testing::IsSupersetOf({"4.0 N, like 410 g", "102 mm deep", "virtual wall"}));
    Scene outside = scene_with(0.01);
    outside.cut_away->phase = TissuePhase::kFree;
    outside.cut_away->force_tissue_N = 0;
    outside.cut_away->fixture_present = false;
    EXPECT_THAT(texts(outside), testing::Not(testing::Contains(testing::HasSubstr("deep"))));
    EXPECT_THAT(texts(outside), testing::Not(testing::Contains("virtual wall")));
}

// A hand that shoves: the numbers stay, and everything is drawn within the picture.
TEST(Cutaway, ANeedleThatGoesOnStaysInThePicture) {
    const Scene scene = scene_with(0.26);
    const CutawayPlan plan = plan_cutaway(kArea);
    EXPECT_THAT(texts(scene), testing::Contains("240 mm deep"));
    for (const CutawayLabel& label : cutaway_labels(scene, plan)) EXPECT_LT(label.at.y, 590) << label.text;
    Mesh deep, deeper;
    build_cutaway(scene, plan, deep);
    build_cutaway(scene_with(0.30), plan, deeper);
    EXPECT_EQ(deep.indices(), deeper.indices());
    for (std::size_t i = 0; i < deep.vertices().size(); ++i)
        ASSERT_EQ(deep.vertices()[i].y, deeper.vertices()[i].y) << i;
}

TEST(Cutaway, ModalitiesHaveWordsOfTheirOwn) {
    EXPECT_THAT(texts(scene_with(0.1, Modality::kCCF)),
                testing::IsSupersetOf({"force on the other hand", "moving hand"}));
    EXPECT_THAT(texts(scene_with(0.1, Modality::kVF)), testing::Contains("force as a bar"));
}

TEST(Cutaway, TheBarIsAmongTheTrianglesWithItsScale) {
    Scene scene = scene_with(0.1, Modality::kVF);
    Mesh without, with;
    build_cutaway(scene, plan_cutaway(kArea), without);
    scene.bar_shown = true;
    scene.bar_N = 6;
    build_cutaway(scene, plan_cutaway(kArea), with);
    EXPECT_GT(with.vertices().size(), without.vertices().size());
    EXPECT_THAT(texts(scene), testing::IsSupersetOf({"0", "12 N"}));
}

// A window of any size, and a needle anywhere, give numbers that a painter can draw.
TEST(Cutaway, DrawsWhateverItIsGiven) {
    Mesh mesh;
    for (const double needle_m : {-9.0, 0.0, 0.3, std::numeric_limits<double>::quiet_NaN()}) {
        for (const Rect& area : {kArea, Rect{10, 20, 1, 1}, Rect{0, 0, 3840, 2160}}) {
            build_cutaway(scene_with(needle_m), plan_cutaway(area), mesh);
            EXPECT_TRUE(
                std::all_of(mesh.vertices().begin(), mesh.vertices().end(),
                            [](const Mesh::Vertex& v) { return std::isfinite(v.x) && std::isfinite(v.y); }))
                << needle_m;
            for (const std::uint32_t index : mesh.indices()) ASSERT_LT(index, mesh.vertices().size());
        }
    }
}

TEST(Cutaway, IsInASceneWhereItIsAskedFor) {
    for (const bool asked : {false, true}) {
        VisualNode node(VisualSettings{.cut_away = asked});
        node.start_trial(from_nanoseconds(1), {.fixture_position_m = 0.11}, 1);
        node.on_picture(node.next_frame(), {.position_needle_m = 0.1});
        const Scene scene = node.frame(node.next_frame()).value();
        ASSERT_EQ(scene.cut_away.has_value(), asked);
        if (!asked) continue;
        EXPECT_EQ(scene.cut_away->position_fixture_m, 0.11);
        EXPECT_EQ(scene.cut_away->position_needle_m, 0.1);
    }
}

}  // namespace
}  // namespace thimble
