#include "visual_node/views/monitor_text.hpp"

#include <limits>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace thimble {
namespace {

std::string value_of(const Monitor& monitor, std::string_view name, std::uint32_t trial = 4) {
    for (const Reading& reading : read_monitor(monitor, trial)) {
        if (reading.name == name) return reading.value.c_str();
    }
    return "no such reading";
}

TEST(MonitorText, NumbersHaveUnitsAndWhatIsNotKnownIsSaidToBe) {
    const std::string not_known(kNotKnownText);
    const std::vector<std::pair<TextLine, std::string>> texts{
        {length_text(0.0123456), "12.35 mm"},
        {length_text(-1e-9), "0.00 mm"},
        {force_text(-3.2), "-3.20 N"},
        {force_text(-0.001), "0.00 N"},
        {force_text(-0.0), "0.00 N"},
        {time_text(0.0123), "12.3 ms"},
        {time_text(1.5), "1.50 s"},
        {age_text(std::chrono::milliseconds{4}), "4 ms"},
        {age_text(std::chrono::milliseconds{1234}), "1.2 s"},
        {age_text(std::chrono::seconds{119}), "119.0 s"},
        {age_text(std::chrono::seconds{120}), "2 min"},
        {age_text(std::chrono::minutes{119}), "119 min"},
        {age_text(std::chrono::minutes{125}), "2 h 5 min"},
        {age_text(Duration::max()), "no message yet"},
        {one_way_text(-1, 0), not_known},
        {one_way_text(0.01, 0.01), not_known},
        {one_way_text(0.01, 0.02), not_known},
        {one_way_text(0, 0), not_known},
        {one_way_text(0.0249, 0.0003), "24.9 ms ± 0.3 ms"},
        {round_trip_text(0), not_known},
        {round_trip_text(0.051), "51.0 ms"}};
    for (const auto& [text, expected] : texts) EXPECT_EQ(text.view(), expected);
    EXPECT_EQ(value_of({}, "one way"), kNotKnownText);
    EXPECT_EQ(value_of({}, "round trip"), kNotKnownText);
}

TEST(MonitorText, SaysWhichTrialAndHowItStands) {
    EXPECT_EQ(trial_text(0, 0).view(), "none yet");
    EXPECT_EQ(trial_text(3, 0).view(), "3, no planned number");
    EXPECT_EQ(trial_text(3, 24).view(), "3 of 24");
    Monitor monitor;
    EXPECT_EQ(state_text(monitor).view(), "between trials");
    monitor.paused = true;
    EXPECT_EQ(state_text(monitor).view(), "paused");
    monitor.reason = EndReason::kTimeout;
    EXPECT_EQ(state_text(monitor).view(), "paused, last: timeout");
    monitor.state = NodeState::kRunning;
    monitor.time_s = 2.25;
    EXPECT_EQ(state_text(monitor).view(), "running, 2.2 s, then a pause");
}

TEST(MonitorText, ReadingsFollowTheMonitor) {
    Monitor monitor;
    monitor.position_needle_m = 0.13;
    monitor.position_surface_m = 0.02;
    monitor.position_fixture_m = 0.125;
    monitor.phase = TissuePhase::kPenetrated;
    monitor.energy_in_J = -0.0021;
    monitor.force_tissue_N = -0.4;
    monitor.force_fixture_N = -3;
    monitor.force_hand_N = 3.4;
    monitor.accepted = 12345678901ULL;
    monitor.refused = 3;
    EXPECT_EQ(value_of(monitor, "needle"), "130.00 mm");
    EXPECT_EQ(value_of(monitor, "in tissue"), "110.00 mm");
    EXPECT_EQ(value_of(monitor, "beyond fixture"), "5.00 mm");
    EXPECT_EQ(value_of(monitor, "tissue force"), "0.40 N");
    EXPECT_EQ(value_of(monitor, "fixture force"), "3.00 N");
    EXPECT_EQ(value_of(monitor, "handle force"), "3.40 N");
    EXPECT_EQ(value_of(monitor, "port energy"), "-2.10 mJ, gives out more than it received");
    EXPECT_EQ(value_of(monitor, "packets"), "12345678901 in, 3 rejected");
    monitor.fixture_present = false;
    monitor.phase = TissuePhase::kContact;
    EXPECT_EQ(value_of(monitor, "fixture"), "removed");
    EXPECT_EQ(value_of(monitor, "beyond fixture"), "no fixture");
    EXPECT_EQ(value_of(monitor, "in tissue"), "outside");
    monitor.needle_held = true;
    EXPECT_EQ(value_of(monitor, "tissue"), "contact, needle held");
}

TEST(MonitorText, EveryReadingHasItsOwnNameAndAValue) {
    std::set<std::string_view> names;
    for (const Reading& reading : read_monitor({}, 0)) {
        EXPECT_TRUE(names.insert(reading.name).second) << reading.name;
        EXPECT_FALSE(reading.value.view().empty()) << reading.name;
    }
    EXPECT_EQ(names.size(), kReadingCount);
}

TEST(TextLine, CutsWhatIsTooLong) {
    const std::string text(500, 'x');
    EXPECT_EQ(TextLine::of("{}", text).view(), std::string(95, 'x'));
    EXPECT_TRUE(TextLine{}.view().empty());
}

// Rounding of encoder steps is neither passive nor active.
TEST(EnergyBalance, WhatGoesInIsPassiveWhatComesOutIsNot) {
    const std::vector<std::pair<double, EnergyBalance>> cases{
        {0.02, EnergyBalance::kPassive},
        {1.01 * kEnergyResolution_J, EnergyBalance::kPassive},
        {kEnergyResolution_J, EnergyBalance::kNone},
        {0, EnergyBalance::kNone},
        {-kEnergyResolution_J, EnergyBalance::kNone},
        {std::numeric_limits<double>::quiet_NaN(), EnergyBalance::kNone},
        {-1.01 * kEnergyResolution_J, EnergyBalance::kActive},
        {-0.02, EnergyBalance::kActive}};
    for (const auto& [energy_J, balance] : cases) EXPECT_EQ(judge_energy(energy_J), balance) << energy_J;
    EXPECT_STREQ(to_string(EnergyBalance::kActive), "gives out more than it received");
    EXPECT_STREQ(to_string(EnergyBalance::kPassive), "passive");
}

}  // namespace
}  // namespace thimble
