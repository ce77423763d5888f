// The element of examples/additions/element.patch, [gel]: a scene reads, names, checks and steps it, and lets it sleep.
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "slave_sim/element_types.hpp"
#include "slave_sim/needle_scene.hpp"
#include "slave_sim/scene_file.hpp"
#include "slave_sim/solvers.hpp"

namespace thimble {
namespace {

NeedleScene scene_of(const std::string& text) {
    const ConfigFile file = ConfigFile::parse(text, "gel.toml");
    const SceneDeclaration declared = read_scene(file, "gel.toml");
    file.finish();
    return {declared, solver_maker({})};
}

TEST(ElementExample, IsRegisteredBesideTheOthers) {
    std::vector<std::string_view> tables;
    for (const ElementType& type : element_types()) tables.push_back(type.table);
    EXPECT_THAT(tables, testing::IsSupersetOf({"tissue", "vessel", "fixture", "guidance", "gel"}));
}

TEST(ElementExample, DragsInsideAndSleepsAbove) {
    NeedleScene scene = scene_of("[gel]\ndamping_Ns_per_m = 3\nfrom_m = 0.01\nto_m = 0.02\n");
    EXPECT_EQ(scene.element_name(0), "gel");
    scene.reset({0, 0});
    scene.step(0, 0.5, {0.01, 0.01});
    EXPECT_EQ(scene.awake(), 0u);
    EXPECT_EQ(scene.force_tissue_N(), 0);
    scene.step(0.5, 0.5, {0.015, 0.015});  // at 0.01 m/s
    EXPECT_EQ(scene.awake(), 1u);
    EXPECT_NEAR(scene.force_tissue_N(), -0.03, 1e-15);
    scene.step(1, 0.5, {0.03, 0.03});
    EXPECT_EQ(scene.force_tissue_N(), 0);
}

TEST(ElementExample, SeveralAreNamedAndSummed) {
    NeedleScene scene = scene_of("[[gel]]\n[[gel]]\nname = 'agar'\n[tissue]\nrest_position_m = 0.5\n");
    EXPECT_EQ(scene.element_name(1), "gel1");
    EXPECT_EQ(scene.element_name(2), "agar");
    scene.reset({0.055, 0.055});
    scene.step(0, 1, {0.056, 0.056});
    EXPECT_NEAR(scene.force_tissue_N(), 2 * -2 * 1e-3, 1e-15);  // the printed default, twice
}

TEST(ElementExample, UnknownKeysAreRefused) {
    EXPECT_THROW(scene_of("[gel]\ncolour = 1\n"), Error);
    EXPECT_THROW(scene_of("[gel]\nfrom_m = 2\n"), Error);
}

}  // namespace
}  // namespace thimble
