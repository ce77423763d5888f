#include <limits>

#include <gtest/gtest.h>

#include "visual_node/views/monitor_text.hpp"

namespace thimble {
namespace {

TEST(EnergyBalance, WhatGoesInIsPassiveWhatComesOutIsNot) {
    EXPECT_EQ(judge_energy(0.02), EnergyBalance::kPassive);
    EXPECT_EQ(judge_energy(-0.02), EnergyBalance::kActive);
    EXPECT_STREQ(to_string(judge_energy(-0.02)), "gives out more than it got");
    EXPECT_STREQ(to_string(judge_energy(0.02)), "passive");
}

TEST(EnergyBalance, RoundingOfEncoderStepsIsNeither) {
    EXPECT_EQ(judge_energy(0), EnergyBalance::kNone);
    EXPECT_EQ(judge_energy(kEnergyResolution_J), EnergyBalance::kNone);
    EXPECT_EQ(judge_energy(-kEnergyResolution_J), EnergyBalance::kNone);
    EXPECT_EQ(judge_energy(-1.01 * kEnergyResolution_J), EnergyBalance::kActive);
    EXPECT_EQ(judge_energy(1.01 * kEnergyResolution_J), EnergyBalance::kPassive);
    EXPECT_EQ(judge_energy(std::numeric_limits<double>::quiet_NaN()), EnergyBalance::kNone);
}

}  // namespace
}  // namespace thimble
