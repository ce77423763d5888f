// Rules of the compensators that only resets, late samples and old news show, reckoned by hand.
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/control/built_in_controllers.hpp"
#include "common/control/control_settings.hpp"
#include "common/control/two_port_passivity.hpp"
#include "common/control/wave_channel.hpp"
#include "common/error.hpp"
#include "tests/refusal.hpp"
#include "tests/unit/control/compensator_loops.hpp"

namespace thimble::test {
namespace {

constexpr double kRule_s = 1e-3;

TEST(CompensatorRules, AResetFixtureHasItsFirstStiffnessAgain) {
    LocalFixture fixture{LocalFixtureSettings{}};
    learn_wall(fixture, 5000);
    fixture.reset();
    EXPECT_FALSE(fixture.known());
    fixture.learn(0.041, 4);
    EXPECT_EQ(fixture.stiffness_N_per_m(), 3000);
}

TEST(CompensatorRules, AFixtureForgetsPairsOlderThanItsMemory) {
    LocalFixtureSettings settings;
    settings.memory = 20;
    LocalFixture fixture{settings};
    learn_wall(fixture, 5000);
    learn_wall(fixture, 2000);
    EXPECT_NEAR(fixture.stiffness_N_per_m(), 2000, 1e-3);
}

TEST(CompensatorRules, AResetPortKnowsNoPosition) {
    LeastConservativeBound bound({kRule_s, 0.5});
    bound.observe(0, 0, 0);
    bound.observe(kRule_s, 1e-3, 10);
    EXPECT_GT(bound.energy_J(), 0);
    bound.reset();
    bound.observe(0, 5e-3, 10);  // the first sample has no time before it
    EXPECT_EQ(bound.refused(), 0U);
    EXPECT_EQ(bound.energy_J(), 0);
}

TEST(CompensatorRules, ASampleWithoutTimeIsRefused) {
    MemorylessBound bound({kRule_s, 0.5});
    bound.observe(0, 0, 0);
    bound.observe(kRule_s, 1e-3, 3);
    EXPECT_GT(bound.force_N(5), 0);
    bound.observe(0, 2e-3, 3);
    EXPECT_EQ(bound.refused(), 1U);
    EXPECT_EQ(bound.force_N(5), 0);
}

// c = 2 b / h = 1000 N/m: F^2 + 2 c F Dx + c^2 Dx^2 h / T = 9 + 6 + 0.5 N^2.
TEST(CompensatorRules, ALateSampleReachesLess) {
    MemorylessBound bound({kRule_s, 0.5});
    bound.observe(0, 0, 0);
    bound.observe(2 * kRule_s, 1e-3, 3);
    EXPECT_DOUBLE_EQ(bound.reach_N(), std::sqrt(15.5));
}

TEST(CompensatorRules, AnOlderToldEnergyTakesNothingBack) {
    TwoPortMaster master({kRule_s, 0}, 1000);
    master.observe(0, 0);
    master.observe(-1e-3, 5);
    EXPECT_EQ(master.force_N(5, 0.01), 5);
    EXPECT_EQ(master.force_N(5, 0), 5) << "0.01 J were heard of before";
}

TEST(CompensatorRules, AWallPushesFromWhereItStands) {
    TwoPortWall wall(0.04, 1000, 12);
    EXPECT_EQ(wall.force_N(0.039, 1), 0);
    EXPECT_NEAR(wall.force_N(0.041, 1), 1, 1e-9);
}

WaveBurst one_wave(std::uint32_t number, double wave_root_W) {
    WaveBurst burst;
    burst.number = number;
    burst.count = 1;
    burst.wave_root_W.front() = wave_root_W;
    return burst;
}

TEST(CompensatorRules, NoWaveOfTheLastTrialIsPlayed) {
    WaveReceiver receiver({}, 0);
    for (std::uint32_t n = 0; n < 5; ++n) receiver.receive(one_wave(n, 1));
    receiver.reset(0);
    for (std::uint32_t n = 0; n < 5; ++n) EXPECT_EQ(receiver.play(n), 0);
    EXPECT_EQ(receiver.missing(), 5U);
}

// 16384 places: the two waves have the same one.
TEST(CompensatorRules, AnOldWaveDoesNotTakeANewOnesPlace) {
    WaveReceiver receiver({}, 0);
    receiver.receive(one_wave(16385, 2));
    receiver.receive(one_wave(1, 1));
    EXPECT_EQ(receiver.play(16385), 2);
}

TEST(CompensatorRules, AWaveIsPlayedOnce) {
    WaveReceiver receiver({}, 0);
    receiver.receive(one_wave(5, 2));
    EXPECT_EQ(receiver.play(5), 2);
    receiver.play_out_after(1);
    EXPECT_EQ(receiver.play(6), 0);
    EXPECT_EQ(receiver.missing(), 0U);
}

TEST(CompensatorRules, AnEnergyLimitedWaveGivesOutWhatCameIn) {
    WaveChannelSettings settings;
    settings.reconstruction = WaveReconstruction::kEnergyLimited;
    WaveReceiver receiver(settings, 0);
    WaveBurst burst = one_wave(0, 2);
    burst.sum_root_W_s = 1;  // far more than it may make good at once
    burst.energy_J = 0.5 * 2 * 2 * settings.sample_period_s;
    receiver.receive(burst);
    EXPECT_DOUBLE_EQ(receiver.play(0), 2);
    EXPECT_DOUBLE_EQ(receiver.energy_out_J(), burst.energy_J);
}

// Table [control]: what it takes and what it refuses.
ControlSettings control_of(const std::string& text) {
    const ConfigFile file = ConfigFile::parse("[control]\n" + text, "session.toml");
    const ControlSettings settings = read_control_settings(file);
    file.finish();
    return settings;
}

std::string refusal_of(const std::string& text) {
    return refusal([&] { control_of(text); }, ExitCode::kUsage);
}

TEST(ControlSettings, WithoutATableThereIsNoCompensator) {
    EXPECT_EQ(control_of("").compensator, Compensator::kNone);
    EXPECT_EQ(control_of("").hand_share(), 1);
}

// A key whose name the session does not have would shift the values behind it.
void expect_session_defaults(const ControlSettings& s, const thimble_controller& table) {
    EXPECT_EQ(table.name, kCompensatorNames[static_cast<std::size_t>(s.compensator)]);
    EXPECT_EQ(wrong_table(table), "") << table.name;
    std::vector<double> fallbacks;
    fallbacks.reserve(table.key_count);
    for (std::size_t key = 0; key < table.key_count; ++key) fallbacks.push_back(table.keys[key].fallback);
    EXPECT_EQ(values_of(s), fallbacks) << table.name;
}

TEST(ControlSettings, EachCompensatorHasItsNameAndKeys) {
    for (std::size_t i = 0; i < kBuiltInCompensators.size(); ++i) {
        const ControlSettings s = control_of("compensator = \"" + std::string(kCompensatorNames[i]) + "\"");
        EXPECT_EQ(s.compensator, static_cast<Compensator>(i));
        const thimble_controller* const table = controller_of(s);
        ASSERT_EQ(table == nullptr, s.compensator == Compensator::kNone) << kCompensatorNames[i];
        if (table != nullptr) expect_session_defaults(s, *table);
        EXPECT_EQ(s.hand_share() < 1,
                  s.compensator == Compensator::kScaled || s.compensator == Compensator::kPredictedShare);
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
    EXPECT_THAT(refusal_of("compensator = \"local-fixture\"\nlocal_stiffness_N_per_m = 9500.0"),
                testing::HasSubstr("local_stiffness_N_per_m"));
}

}  // namespace
}  // namespace thimble::test
