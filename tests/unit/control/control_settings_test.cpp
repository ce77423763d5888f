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

TEST(ControlSettings, WhatIsWithoutEffectOrUnknownIsRefused) {
    EXPECT_THAT(refusal_of("share = 0.1"), testing::HasSubstr("compensator = \"none\""));
    EXPECT_THAT(refusal_of("compensator = \"wave\"\nshare = 0.1"), testing::HasSubstr("choose scaled"));
    EXPECT_THAT(refusal_of("compensator = \"waves\""), testing::HasSubstr("local-fixture, wave"));
    EXPECT_THAT(refusal_of("compensato = \"wave\""), testing::HasSubstr("unknown key"));
    EXPECT_NE(refusal_of("compensator = \"local-fixture\"\nlocal_stiffness_N_per_m = 9500.0"), "");
}

}  // namespace
}  // namespace thimble
