// The keys velocity_* of [master]: what they choose, and what is refused.
#include "master/velocity_settings.hpp"

#include <string>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "master/master_node.hpp"

namespace thimble::test {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

VelocitySettings read(const std::string& keys) {
    const ConfigFile file = ConfigFile::parse("[master]\n" + keys, "test");
    const VelocitySettings settings = read_master_settings(file.table("master")).velocity;
    file.finish();
    return settings;
}

std::string refusal_of(const std::string& keys) {
    try {
        read(keys);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kUsage);
        return error.what();
    }
    return "accepted";
}

TEST(VelocitySettings, NominalWithoutKeys) {
    const VelocitySettings read_ones = read(""), nominal;
    EXPECT_EQ(read_ones.method, nominal.method);
    EXPECT_EQ(read_ones.time_constant, nominal.time_constant);
    EXPECT_EQ(read_ones.window, nominal.window);
    EXPECT_EQ(read_ones.fit, nominal.fit);
    EXPECT_DOUBLE_EQ(read_ones.quantum_m, nominal.quantum_m);
    EXPECT_EQ(read_ones.acceleration_noise_m2_per_s3, nominal.acceleration_noise_m2_per_s3);
    EXPECT_EQ(read_ones.sample_period, nominal.sample_period);
}

TEST(VelocitySettings, EachEstimatorWithItsKeys) {
    const VelocitySettings low_pass =
        read("velocity_estimator = \"low_pass\"\nvelocity_time_constant_s = 0.003");
    EXPECT_EQ(low_pass.method, VelocityMethod::kLowPass);
    EXPECT_EQ(low_pass.time_constant, Duration{milliseconds{3}});
    EXPECT_EQ(read("velocity_estimator = \"raw\"").method, VelocityMethod::kRaw);
    const VelocitySettings windowed = read("velocity_estimator = \"windowed\"\nvelocity_window_s = 0.012");
    EXPECT_EQ(windowed.method, VelocityMethod::kWindowed);
    EXPECT_EQ(windowed.window, Duration{milliseconds{12}});
    const VelocitySettings foaw = read(
        "velocity_estimator = \"foaw\"\nvelocity_window_s = 0.03\nvelocity_foaw_fit = \"end\"\n"
        "velocity_quantum_needle_m = 1e-6");
    EXPECT_EQ(foaw.method, VelocityMethod::kFoaw);
    EXPECT_EQ(foaw.fit, FoawFit::kEnd);
    EXPECT_EQ(foaw.window, Duration{milliseconds{30}});
    EXPECT_EQ(foaw.quantum_m, 1e-6);
    const VelocitySettings kalman = read(
        "velocity_estimator = \"kalman\"\nvelocity_process_noise_m2_per_s3 = 0.002\n"
        "velocity_quantum_needle_m = 2e-6\nsample_period_s = 0.0005");
    EXPECT_EQ(kalman.method, VelocityMethod::kKalman);
    EXPECT_EQ(kalman.acceleration_noise_m2_per_s3, 0.002);
    EXPECT_EQ(kalman.quantum_m, 2e-6);
    EXPECT_EQ(kalman.sample_period, Duration{microseconds{500}});
}

TEST(VelocitySettings, TheQuantumFollowsThePositionScale) {
    EXPECT_DOUBLE_EQ(read("position_scale = 5.0").quantum_m, 5e-5);
}

TEST(VelocitySettings, AnUnknownEstimatorIsToldTheKnownOnes) {
    const std::string why = refusal_of("velocity_estimator = \"magic\"");
    EXPECT_NE(why.find("test:2"), std::string::npos) << why;
    for (const std::string_view name : kVelocityMethodNames)
        EXPECT_NE(why.find(name), std::string::npos) << why;
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

TEST(VelocitySettings, OutOfRangeIsRefused) {
    for (const char* keys : {"velocity_estimator = \"low_pass\"\nvelocity_time_constant_s = -0.001",
                             "velocity_estimator = \"low_pass\"\nvelocity_time_constant_s = 1.5",
                             "velocity_estimator = \"windowed\"\nvelocity_window_s = 0.0",
                             "velocity_estimator = \"windowed\"\nvelocity_window_s = 0.0005",
                             "velocity_estimator = \"foaw\"\nvelocity_quantum_needle_m = 0.0",
                             "velocity_estimator = \"kalman\"\nvelocity_process_noise_m2_per_s3 = 0.0",
                             "velocity_estimator = \"foaw\"\nvelocity_foaw_fit = \"middle\""}) {
        EXPECT_NE(refusal_of(keys), "accepted") << keys;
    }
}

TEST(VelocitySettings, AWindowOfMoreSamplesThanAreKeptIsRefused) {
    EXPECT_EQ(refusal_of("velocity_estimator = \"windowed\"\nvelocity_window_s = 0.255"), "accepted");
    const std::string why = refusal_of("velocity_estimator = \"windowed\"\nvelocity_window_s = 0.256");
    EXPECT_NE(why.find("255 times sample_period_s"), std::string::npos) << why;
}

// The default window is shorter than one sample here; it must not stand in the way.
TEST(VelocitySettings, ASlowHandleNeedsNoWindow) {
    EXPECT_EQ(read("sample_period_s = 0.05").window, Duration{milliseconds{50}});
}

TEST(MasterNode, UsesTheEstimatorItIsGiven) {
    MasterSettings settings;
    settings.velocity.method = VelocityMethod::kWindowed;
    settings.velocity.window = milliseconds{10};
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
