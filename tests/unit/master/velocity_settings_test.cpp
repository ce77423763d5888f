// The keys velocity_* of [master]: what they choose, and what is refused.
#include "master/velocity_settings.hpp"

#include <string>

#include <gtest/gtest.h>

#include "master/master_node.hpp"
#include "tests/refusal.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;

VelocitySettings read(const std::string& keys) {
    const ConfigFile file = ConfigFile::parse("[master]\n" + keys, "test");
    const VelocitySettings settings = read_master_settings(file).velocity;
    file.finish();
    return settings;
}

std::string refusal_of(const std::string& keys) {
    return refusal([&] { read(keys); }, ExitCode::kUsage);
}

TEST(VelocitySettings, TheQuantumFollowsThePositionScale) {
    EXPECT_DOUBLE_EQ(read("position_scale = 5.0").quantum_m, 5e-5);
    EXPECT_EQ(read("velocity_quantum_needle_m = 1e-6").quantum_m, 1e-6);
}

TEST(VelocitySettings, NumbersOfTheChosenOne) {
    EXPECT_EQ(read("velocity_estimator = \"low_pass\"\nvelocity_time_constant_s = 0.003").time_constant,
              Duration{milliseconds{3}});
    const VelocitySettings foaw =
        read("velocity_estimator = \"foaw\"\nvelocity_window_s = 0.03\nvelocity_foaw_fit = \"end\"");
    EXPECT_EQ(foaw.method, VelocityMethod::kFoaw);
    EXPECT_EQ(foaw.window, Duration{milliseconds{30}});
    EXPECT_EQ(foaw.fit, FoawFit::kEnd);
    const VelocitySettings kalman = read(
        "velocity_estimator = \"kalman\"\nvelocity_process_noise_m2_per_s3 = 0.002\nsample_period_s = 0.002");
    EXPECT_EQ(kalman.acceleration_noise_m2_per_s3, 0.002);
    EXPECT_EQ(kalman.sample_period, Duration{milliseconds{2}});
}

TEST(VelocitySettings, ANumberOfAnotherEstimatorIsRefused) {
    for (const char* keys : {"velocity_estimator = \"raw\"\nvelocity_time_constant_s = 0.005",
                             "velocity_estimator = \"low_pass\"\nvelocity_window_s = 0.02",
                             "velocity_estimator = \"windowed\"\nvelocity_foaw_fit = \"best\"",
                             "velocity_estimator = \"windowed\"\nvelocity_quantum_needle_m = 1e-5",
                             "velocity_estimator = \"foaw\"\nvelocity_process_noise_m2_per_s3 = 0.01",
                             "velocity_estimator = \"kalman\"\nvelocity_time_constant_s = 0.005"}) {
        EXPECT_NE(refusal_of(keys).find("has no effect"), std::string::npos) << keys;
    }
    EXPECT_NE(
        refusal_of("velocity_estimator = \"raw\"\nvelocity_window_s = 0.02").find("choose windowed or foaw"),
        std::string::npos);
}

TEST(VelocitySettings, AWindowOfMoreSamplesThanAreKeptIsRefused) {
    EXPECT_NO_THROW(read("velocity_estimator = \"windowed\"\nvelocity_window_s = 0.255"));
    EXPECT_THROW(read("velocity_estimator = \"windowed\"\nvelocity_window_s = 0.0005"), Error);
    const std::string why = refusal_of("velocity_estimator = \"windowed\"\nvelocity_window_s = 0.256");
    EXPECT_NE(why.find("255 times sample_period_s"), std::string::npos) << why;
}

// The default window is shorter than one sample here; it must not stand in the way.
TEST(VelocitySettings, ASlowHandleNeedsNoWindow) {
    EXPECT_EQ(read("sample_period_s = 0.05").window, Duration{milliseconds{50}});
}

TEST(MasterNode, UsesTheEstimatorItIsGiven) {
    MasterSettings settings;
    settings.velocity = {.method = VelocityMethod::kWindowed, .window = milliseconds{10}};
    MasterNode master(settings);
    master.start_trial({}, Modality::kHF);
    NeedleCommand command;
    for (int ms = 0; ms <= 50; ++ms) {
        command = master.sample(SessionTime{milliseconds{ms}}, {1e-5 * ms, 0});
    }
    EXPECT_NEAR(command.velocity_needle_m_per_s, 0.03, 1e-12);
    EXPECT_NEAR(command.velocity_hand_m_per_s, 0.01, 1e-12);
    EXPECT_NEAR(command.position_needle_estimate_m, 1.5e-3 - 0.03 * 0.0045, 1e-12);
    // A new trial starts at rest, wherever the handle is.
    master.start_trial({}, Modality::kHF);
    command = master.sample(SessionTime{milliseconds{60}}, {0.02, 0});
    EXPECT_EQ(command.velocity_needle_m_per_s, 0);
    EXPECT_EQ(command.position_needle_estimate_m, 3 * 0.02);
}

}  // namespace
}  // namespace thimble::test
