// Scenes as files: what a table declares, and what is refused.
#include "slave_sim/scene_file.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "slave_sim/element_types.hpp"
#include "slave_sim/needle_scene.hpp"
#include "slave_sim/solvers.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

SceneDeclaration scene_of(const std::string& text) {
    const ConfigFile file = ConfigFile::parse(text, "scene.toml");
    SceneDeclaration scene = read_scene(file, "scene.toml");
    file.finish();
    return scene;
}

std::vector<std::string> names(const SceneDeclaration& scene) {
    std::vector<std::string> list;
    for (const ElementDeclaration& element : scene.elements) list.push_back(element.name);
    return list;
}

std::string refusal_of(const std::string& text) {
    return refusal([&] { scene_of(text); }, ExitCode::kUsage);
}

TEST(SceneFile, DeclaresWhatItNamesAndNothingElse) {
    EXPECT_THAT(names(scene_of("")), ElementsAre());
    EXPECT_THAT(names(scene_of("[tissue]\n")), ElementsAre("tissue"));
    EXPECT_THAT(names(scene_of("[fixture]\n")), ElementsAre("fixture"));
    EXPECT_THAT(names(scene_of("[fixture]\n[tissue]\n[guidance]\n[vessel]\n")),
                ElementsAre("tissue", "vessel.near", "vessel.far", "fixture", "guidance"));
}

TEST(SceneFile, SeveralOfATypeAreNumberedOrNamed) {
    EXPECT_THAT(names(scene_of("[[tissue]]\n[[tissue]]\nname = 'fat'\n[[tissue]]\n")),
                ElementsAre("tissue1", "fat", "tissue3"));
    EXPECT_THAT(names(scene_of("[[tissue]]\n")), ElementsAre("tissue"));
    EXPECT_THAT(names(scene_of("[vessel]\nname = 'artery'\n")), ElementsAre("artery.near", "artery.far"));
}

TEST(SceneFile, TheSurfaceIsTheOutermostLayersNotTheFirst) {
    const SceneDeclaration scene =
        scene_of("[[tissue]]\nrest_position_m = 0.05\n[[tissue]]\nrest_position_m = 0.01\nmass_kg = 1e-12\n");
    EXPECT_EQ(NeedleScene(scene, solver_maker({})).surface()->parameters().mass_kg, 1e-12);
}

TEST(SceneFile, RefusesWithLineAndKey) {
    struct Bad {
        const char* text;
        const char* begins;
        const char* names;
    };
    for (const Bad& bad : std::vector<Bad>{
             {"[tissue]\n[bone]\n", "scene.toml:2:", "'bone'"},
             {"[[tissue]]\n[[tissue]]\nmas_kg = 1\n", "scene.toml:3:", "'tissue[1].mas_kg'"},
             {"[[tissue]]\n[[tissue]]\nmass_kg = 0\n", "scene.toml:3:", "'tissue[1].mass_kg'"},
             {"tissue = 3\n", "", "[[tissue]]"},
             {"tissue = []\n", "", "[[tissue]]"},
             {"[tissue]\nname = 'a,b'\n", "", "'tissue.name'"},
             {"[tissue]\nname = 'x'\n[fixture]\nname = 'x'\n", "", "\"x\" is the name of another element"},
             // Names of parts: event lists could not tell the two apart.
             {"[tissue]\nname = 'vessel.near'\n[vessel]\n", "",
              "\"vessel.near\" is the name of another element"},
             {"[vessel]\nname = 'a'\n[fixture]\nname = 'a.far'\n",
              "scene.toml:4:", "\"a.far\" is the name of another element"},
             {"[fixture]\n[[fixture.event]]\npresent = false\n", "", "time_s"},
             {"[fixture]\n[[fixture.event]]\ntime_s = 1\nafter_contact_s = 2\n",
              "scene.toml:3:", "after_contact_s"},
             {"[fixture]\nstiffness_N_per_m = -1\n", "scene.toml:2:", ""}}) {
        EXPECT_THAT(refusal_of(bad.text), AllOf(StartsWith(bad.begins), HasSubstr(bad.names))) << bad.text;
    }
}

TEST(SceneFile, ThePapersSceneHasThePapersNumbers) {
    const NeedleScene built(paper_scene(), solver_maker({}));
    const TissueParameters& p = built.surface()->parameters();
    EXPECT_EQ(p.mass_kg, 1);
    EXPECT_EQ(p.stiffness_N_per_m, 2);
    EXPECT_EQ(p.damping_Ns_per_m, 5);
    EXPECT_EQ(p.drag_Ns_per_m, 0.7);
    EXPECT_EQ(p.puncture_force_N, 0.1);
    EXPECT_EQ(p.rest_position_m, 0.020);
    EXPECT_EQ(built.fixture()->position_m(), 0.123);
    EXPECT_NEAR(built.fixture()->touch(0.124).force_N, -3, 1e-12);
}

TEST(SceneFile, EverySceneThatComesWithTheProgramIsGood) {
    ASSERT_GE(built_in_scenes().size(), 6u);
    for (const BuiltInScene& scene : built_in_scenes()) {
        SCOPED_TRACE(scene.name);
        const SceneDeclaration declared = load_scene(scene.name);
        EXPECT_FALSE(declared.elements.empty());
        for (const std::string_view solver : kSolverNames) {
            EXPECT_NO_THROW(NeedleScene(declared, solver_maker({solver, 1e-4}))) << solver;
        }
    }
}

TEST(SceneFile, AFileThatIsNotThereNamesTheScenesThatAre) {
    EXPECT_THAT(refusal([] { load_scene("no-such-scene.toml"); }, ExitCode::kUsage),
                AllOf(HasSubstr("no-such-scene.toml"), HasSubstr("paper.toml")));
    for (const char* elsewhere : {"/nowhere/paper.toml", "nowhere/paper.toml"})
        EXPECT_THROW(load_scene(elsewhere), Error) << elsewhere;
}

TEST(ElementTypes, EachIsRegisteredOnce) {
    std::vector<std::string_view> tables;
    for (const ElementType& type : element_types()) tables.push_back(type.table);
    EXPECT_THAT(tables, testing::UnorderedElementsAre("tissue", "vessel", "fixture", "guidance"));
}

}  // namespace
}  // namespace thimble
