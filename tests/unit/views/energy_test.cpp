#include "visual_node/views/energy.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace thimble {
namespace {

TEST(PortEnergy, WhatGoesInIsPassiveWhatComesOutIsNot) {
    EXPECT_EQ(judge_energy(0.02), PortEnergy::kPassive);
    EXPECT_EQ(judge_energy(-0.02), PortEnergy::kActive);
    EXPECT_STREQ(to_string(judge_energy(-0.02)), "gives out more than it got");
    EXPECT_STREQ(to_string(judge_energy(0.02)), "passive");
}

TEST(PortEnergy, RoundingOfEncoderStepsIsNeither) {
    EXPECT_EQ(judge_energy(0), PortEnergy::kNone);
    EXPECT_EQ(judge_energy(kPortEnergyResolution_J), PortEnergy::kNone);
    EXPECT_EQ(judge_energy(-kPortEnergyResolution_J), PortEnergy::kNone);
    EXPECT_EQ(judge_energy(-1.01 * kPortEnergyResolution_J), PortEnergy::kActive);
    EXPECT_EQ(judge_energy(1.01 * kPortEnergyResolution_J), PortEnergy::kPassive);
    EXPECT_EQ(judge_energy(std::numeric_limits<double>::quiet_NaN()), PortEnergy::kNone);
}

}  // namespace
}  // namespace thimble
