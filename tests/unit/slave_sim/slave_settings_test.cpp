#include "slave_sim/slave_settings.hpp"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "slave_sim/needle_scene.hpp"
#include "slave_sim/stepped_tissue.hpp"

namespace thimble {
namespace {

TissueParameters tissue_of(const SlaveSettings& s) {
    return NeedleScene(s.scene, s.make_tissue).surface()->parameters();
}

double fixture_push_N(const SlaveSettings& s, double penetration_m) {
    const NeedleScene scene(s.scene, s.make_tissue);
    return -scene.fixture()->touch(s.fixture_position_m() + penetration_m).force_N;
}

TEST(SlaveSettings, NominalWithoutAFile) {
    const SlaveSettings s = read_slave_settings(ConfigFile::empty());
    const TissueParameters tissue = tissue_of(s);
    EXPECT_EQ(tissue.mass_kg, 1);
    EXPECT_EQ(tissue.stiffness_N_per_m, 2);
    EXPECT_EQ(tissue.damping_Ns_per_m, 5);
    EXPECT_EQ(tissue.drag_Ns_per_m, 0.7);
    EXPECT_EQ(tissue.puncture_force_N, 0.1);
    EXPECT_EQ(tissue.rest_position_m, 0.020);
    EXPECT_NEAR(fixture_push_N(s, 0.001), 3, 1e-12);
    EXPECT_EQ(s.fixture_position_m(), 0.123);
    EXPECT_EQ(s.contact_hold, Duration{std::chrono::seconds(5)});
}

TEST(SlaveSettings, EveryKeyIsRead) {
    const ConfigFile file = ConfigFile::parse(R"(
[tissue]
mass_kg = 2.0
stiffness_N_per_m = 3.0
damping_Ns_per_m = 4.0
drag_Ns_per_m = 0.5
puncture_force_N = 0.25
rest_position_m = 0.03
[fixture]
stiffness_N_per_m = 1000.0
position_m = 0.1
[trial]
contact_hold_s = 2.0
[slave_sim]
stale_after_s = 0.05
longest_step_s = 0.2
)",
                                              "test");
    const SlaveSettings s = read_slave_settings(file);
    const TissueParameters tissue = tissue_of(s);
    EXPECT_NO_THROW(file.finish());
    EXPECT_EQ(tissue.mass_kg, 2);
    EXPECT_EQ(tissue.stiffness_N_per_m, 3);
    EXPECT_EQ(tissue.damping_Ns_per_m, 4);
    EXPECT_EQ(tissue.drag_Ns_per_m, 0.5);
    EXPECT_EQ(tissue.puncture_force_N, 0.25);
    EXPECT_EQ(tissue.rest_position_m, 0.03);
    EXPECT_NEAR(fixture_push_N(s, 0.001), 1, 1e-12);
    EXPECT_EQ(s.fixture_position_m(), 0.1);
    EXPECT_EQ(s.contact_hold, Duration{std::chrono::seconds(2)});
    EXPECT_EQ(s.stale_after, Duration{std::chrono::milliseconds(50)});
    EXPECT_EQ(s.longest_step, Duration{std::chrono::milliseconds(200)});
}

TEST(SlaveSettings, RefusesWhatNoTissueIs) {
    for (const char* text : {"[tissue]\nmass_kg = 0.0", "[tissue]\ndamping_Ns_per_m = -1.0",
                             "[tissue]\npuncture_force_N = 0.0", "[fixture]\nstiffness_N_per_m = -1.0",
                             "[trial]\ncontact_hold_s = 0.0", "[slave_sim]\nstale_after_s = -1.0"}) {
        EXPECT_THROW(read_slave_settings(ConfigFile::parse(text, "test")), Error) << text;
    }
}

SlaveSettings settings_of(const std::string& text) {
    return read_slave_settings(ConfigFile::parse(text, "test"));
}

TEST(SlaveSettings, AnotherSceneAndAnotherSolver) {
    const SlaveSettings s =
        settings_of("[slave_sim]\nscene = 'vessel.toml'\nsolver = 'rk4'\nsolver_step_s = 1e-4\n");
    EXPECT_EQ(s.scene.elements.size(), 4u);
    EXPECT_EQ(s.fixture_position_m(), 0.123);
    EXPECT_NE(dynamic_cast<const SteppedTissue<RungeKutta4>*>(NeedleScene(s.scene, s.make_tissue).surface()),
              nullptr);
}

TEST(SlaveSettings, ASceneBesideTheSessionFileComesFirst) {
    const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "slave_settings";
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "paper.toml") << "[tissue]\nmass_kg = 3\n[fixture]\nposition_m = 0.07\n";
    std::ofstream(folder / "session.toml") << "[slave_sim]\nscene = 'paper.toml'\n";
    const SlaveSettings s = read_slave_settings(ConfigFile::load(folder / "session.toml"));
    EXPECT_EQ(tissue_of(s).mass_kg, 3);
    EXPECT_EQ(s.fixture_position_m(), 0.07);
    std::filesystem::remove_all(folder);
}

TEST(SlaveSettings, RefusesScenesThatNoTrialCanRunIn) {
    for (const char* text : {
             "[tissue]\n[slave_sim]\nscene = 'paper.toml'\n",             // two declarations
             "[slave_sim]\nscene = 'tissue.toml'\n",                      // nothing ends the trial
             "[slave_sim]\nscene = 'no-such-scene.toml'\n",               //
             "[slave_sim]\nsolver = 'euler'\n",                           //
             "[tissue]\nmass_kg = 1e-12\n[slave_sim]\nsolver = 'rk4'\n",  // unstable
         }) {
        EXPECT_THROW(settings_of(text), Error) << text;
    }
}

}  // namespace
}  // namespace thimble
