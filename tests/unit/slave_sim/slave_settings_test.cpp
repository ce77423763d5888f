#include "slave_sim/slave_settings.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "slave_sim/needle_scene.hpp"
#include "slave_sim/stepped_tissue.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

TissueParameters tissue_of(const SlaveSettings& s) {
    return NeedleScene(s.scene, s.make_tissue).surface()->parameters();
}

SlaveSettings settings_of(const std::string& text) {
    return read_slave_settings(ConfigFile::parse(text, "test"));
}

TEST(SlaveSettings, OwnTablesChangeThePapersScene) {
    const SlaveSettings s = settings_of(
        "[tissue]\nmass_kg = 2\n[fixture]\nposition_m = 0.1\n"
        "[slave_sim]\nstale_after_s = 0.05\nlongest_step_s = 0.2\n");
    EXPECT_EQ(tissue_of(s).mass_kg, 2);
    EXPECT_EQ(tissue_of(s).stiffness_N_per_m, 2);
    EXPECT_EQ(s.fixture_position_m(), 0.1);
    EXPECT_EQ(s.stale_after, Duration{std::chrono::milliseconds(50)});
    EXPECT_EQ(s.longest_step, Duration{std::chrono::milliseconds(200)});
}

TEST(SlaveSettings, AContactOutlivesTheLongestTimeBetweenTwoCommands) {
    const std::string rare =
        "[codec]\ncommand = 'deadband'\nrefresh_s = 0.15\n[slave_sim]\nstale_after_s = 0.5\n";
    EXPECT_EQ(settings_of(rare).longest_step, Duration{std::chrono::milliseconds(300)});
    EXPECT_THAT(refusal([&] { settings_of(rare + "longest_step_s = 0.15\n"); }, ExitCode::kUsage),
                testing::HasSubstr("ends each contact"));
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
    const TemporaryDirectory folder;
    write_text(folder / "paper.toml", "[tissue]\nmass_kg = 3\n[fixture]\nposition_m = 0.07\n");
    write_text(folder / "session.toml", "[slave_sim]\nscene = 'paper.toml'\n");
    const SlaveSettings s = read_slave_settings(ConfigFile::load(folder / "session.toml"));
    EXPECT_EQ(tissue_of(s).mass_kg, 3);
    EXPECT_EQ(s.fixture_position_m(), 0.07);
}

TEST(SlaveSettings, ARobotIsWaitedForAndHasItsLimits) {
    EXPECT_EQ(user_limit(settings_of("")), Duration::zero());
    const SlaveSettings s = settings_of("[slave_sim]\ndevice = 'ros2'\nros2.deepest_m = 0.02\n");
    EXPECT_EQ(s.device, SlaveDevice::kRos2);
    EXPECT_EQ(user_limit(s), kRos2DriverLimit);
    EXPECT_EQ(s.robot.deepest_m, 0.02);
    for (const char* text :
         {"deepest_m = -0.05\n", "speed_limit_m_per_s = 0\n", "[control]\ncompensator = 'two-port'\n"})
        EXPECT_THROW(settings_of(std::string("[slave_sim]\ndevice = 'ros2'\n[slave_sim.ros2]\n") + text),
                     Error)
            << text;
}

TEST(SlaveSettings, ARobotIsToldEachCommand) {
    const std::string robot = "[slave_sim]\ndevice = 'ros2'\n";
    EXPECT_NO_THROW(settings_of(robot + "[codec]\nforce = 'deadband'\n"));
    for (const char* codec : {"deadband", "deadband-linear", "every-nth", "send-on-delta"})
        EXPECT_THAT(
            refusal([&] { settings_of(robot + "[codec]\ncommand = '" + codec + "'\n"); }, ExitCode::kUsage),
            testing::HasSubstr("leaves out commands, but a robot needs every command"));
}

TEST(SlaveSettings, RefusesScenesThatNoTrialCanRunIn) {
    for (const char* text : {
             "[tissue]\n[slave_sim]\nscene = 'paper.toml'\n",             // two declarations
             "[slave_sim]\nscene = 'tissue.toml'\n",                      // nothing ends the trial
             "[slave_sim]\nscene = 'no-such-scene.toml'\n",               //
             "[slave_sim]\nstale = 'zero'\n",                             // would move without a command
             "[tissue]\nmass_kg = 1e-12\n[slave_sim]\nsolver = 'rk4'\n",  // unstable
             "[slave_sim]\nstale_after_s = 0.001\n",                      // held between two commands
             "[master]\nsample_period_s = 0.02\n",                        //
         }) {
        EXPECT_THROW(settings_of(text), Error) << text;
    }
}

}  // namespace
}  // namespace thimble
