// Table [control]: what it takes and what it refuses.
#include "common/control/control_settings.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"

namespace thimble {
namespace {

ControlSettings control_of(const std::string& text) {
    const ConfigFile file = ConfigFile::parse("[control]\n" + text, "session.toml");
    const ControlSettings settings = read_control_settings(file.table("control"));
    file.finish();
    return settings;
}

std::string refusal_of(const std::string& text) {
    try {
        control_of(text);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kUsage);
        return error.what();
    }
    return "";
}

TEST(ControlSettings, WithoutATableThereIsNoCompensator) {
    EXPECT_EQ(control_of("").compensator, Compensator::kNone);
    EXPECT_EQ(control_of("").hand_share(), 1);
}

TEST(ControlSettings, EachCompensatorHasItsName) {
    for (std::size_t i = 0; i < kCompensatorNames.size(); ++i) {
        const ControlSettings s = control_of("compensator = \"" + std::string(kCompensatorNames[i]) + "\"");
        EXPECT_EQ(s.compensator, static_cast<Compensator>(i));
        EXPECT_EQ(s.hand_share() < 1, s.compensator == Compensator::kScaled);
    }
}

TEST(ControlSettings, NumbersOfTheChosenOne) {
    const ControlSettings tank =
        control_of("compensator = \"two-layer\"\ntank_level_J = 0.1\ndevice_damping_Ns_per_m = 0.25");
    EXPECT_EQ(tank.tank.level_J, 0.1);
    EXPECT_EQ(tank.device_damping_Ns_per_m, 0.25);
    const ControlSettings waves = control_of(
        "compensator = \"wave\"\nwave_impedance_Ns_per_m = 30\nwave_repeats = 7\n"
        "wave_reconstruction = \"hold-last\"");
    EXPECT_EQ(waves.wave_impedance_Ns_per_m, 30);
    EXPECT_EQ(waves.channel.repeats, 7U);
    EXPECT_EQ(waves.channel.reconstruction, WaveReconstruction::kHoldLast);
    EXPECT_EQ(control_of("compensator = \"passivity\"\nmost_damping_Ns_per_m = 7").most_damping_Ns_per_m, 7);
    EXPECT_EQ(control_of("compensator = \"scaled\"\nshare = 0.1").hand_share(), 0.1);
}

TEST(ControlSettings, WhatIsWithoutEffectOrUnknownIsRefused) {
    EXPECT_THAT(refusal_of("share = 0.1"), testing::HasSubstr("compensator = \"none\""));
    EXPECT_THAT(refusal_of("compensator = \"wave\"\nshare = 0.1"), testing::HasSubstr("choose scaled"));
    EXPECT_THAT(refusal_of("compensator = \"waves\""), testing::HasSubstr("local-fixture, wave"));
    EXPECT_THAT(refusal_of("compensato = \"wave\""), testing::HasSubstr("unknown key"));
    EXPECT_NE(refusal_of("compensator = \"local-fixture\"\nlocal_stiffness_N_per_m = 9500.0"), "");
}

}  // namespace
}  // namespace thimble
