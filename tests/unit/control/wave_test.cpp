// Wave variables: what is lossless, what is passive over any network, and what is not.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "common/control/wave_channel.hpp"
#include "common/control/wave_variables.hpp"
#include "common/error.hpp"
#include "common/random.hpp"

namespace thimble {
namespace {

constexpr double kTickWave_s = 1e-3;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

TEST(Waves, AnImpedanceOfZeroOrInfinityIsRefused) {
    for (const double impedance : {0.0, -1.0, kInfinite, std::nan("")}) {
        EXPECT_THROW(WaveMaster({impedance, kTickWave_s}), Error) << impedance;
        EXPECT_THROW(WaveSlave({impedance, kTickWave_s}), Error) << impedance;
    }
    EXPECT_THROW(WaveSlave({20, 0}), Error);
    EXPECT_THROW(WaveSlave({20, kTickWave_s, -1}), Error);
}

// For any wall and any other force, saturated or not: F dx = h (u^2 - w^2) / 2.
TEST(Waves, TheSlaveIsLossless) {
    RandomStream random({5, 1, 1, 1, Purpose::kParameter});
    for (const double stiffness_N_per_m : {0.0, 1.0, 9000.0, 1e7, kInfinite}) {
        WaveSlave slave({20, kTickWave_s, stiffness_N_per_m > 10 ? 5.0 : 0.0});
        slave.place(-1e-3);
        for (int i = 0; i < 2000; ++i) {
            const double before_m = slave.position_m(), u = 3 * random.normal();
            const double other_N = i % 3 == 0 ? random.uniform(-2, 2) : 0;
            const double w = slave.step(u, {0, stiffness_N_per_m}, other_N, 12);
            const double got_J = slave.force_N() * (slave.position_m() - before_m);
            ASSERT_NEAR(got_J, 0.5 * kTickWave_s * (u * u - w * w), 1e-12) << stiffness_N_per_m;
            ASSERT_LE(std::fabs(slave.force_N()), 12);
        }
    }
}

TEST(Waves, AFreeSlaveSendsBackWhatItsDamperDoesNotTake) {
    for (const auto& [damping_Ns_per_m, back] :
         {std::pair{0.0, 1.0}, std::pair{20.0, 0.0}, std::pair{60.0, -0.5}}) {
        WaveSlave slave({20, kTickWave_s, damping_Ns_per_m});
        EXPECT_NEAR(slave.step(0.7, {1, 9000}, 0, 12), 0.7 * back, 1e-12) << damping_Ns_per_m;
    }
}

TEST(Waves, ARigidWallIsNotPassed) {
    WaveSlave slave({20, kTickWave_s});
    for (int i = 0; i < 100; ++i) slave.step(0.3, {0, kInfinite}, 0, 1e6);
    EXPECT_NEAR(slave.position_m(), 0, 1e-15);
    EXPECT_GT(slave.force_N(), 1);
}

TEST(Waves, WhatIsNoNumberStandsForRest) {
    WaveMaster master({20, kTickWave_s});
    master.wave_out(0, 0);
    EXPECT_EQ(master.wave_out(std::nan(""), kInfinite), 0);
    EXPECT_EQ(master.wave_out(0, 0), 0);
}

// A network that does everything: when each burst arrives, in ticks; none: lost.
struct Arrival {
    int tick;
    WaveBurst burst;
};

std::vector<Arrival> over_network(const WaveChannelSettings& settings, const std::vector<double>& waves,
                                  int delay, int jitter, double loss, RandomStream& random) {
    WaveSender sender(settings);
    std::vector<Arrival> arrivals;
    arrivals.reserve(2 * waves.size());
    for (std::size_t k = 0; k < waves.size(); ++k) {
        const WaveBurst burst = sender.add(waves[k]);
        if (random.uniform() < loss) continue;
        const auto when = [&] {
            return static_cast<int>(k) + delay +
                   (jitter > 0 ? static_cast<int>(random.below(static_cast<std::uint32_t>(jitter) + 1)) : 0);
        };
        arrivals.push_back({when(), burst});
        if (random.uniform() < 0.05) arrivals.push_back({when(), burst});  // twice
    }
    std::stable_sort(arrivals.begin(), arrivals.end(),
                     [](const Arrival& a, const Arrival& b) { return a.tick < b.tick; });
    return arrivals;
}

struct Played {
    std::vector<double> waves;
    double least_J = 0;  // of energy sent minus energy given out, at any time
    std::uint64_t missing = 0;
};

Played play(const WaveChannelSettings& settings, const std::vector<double>& sent,
            const std::vector<Arrival>& arrivals, std::uint32_t play_out, bool changing = false) {
    WaveReceiver receiver(settings, play_out);
    Played played;
    played.waves.reserve(sent.size());
    double stored_J = 0;
    std::size_t next = 0;
    for (std::size_t n = 0; n < sent.size(); ++n) {
        stored_J += 0.5 * kTickWave_s * sent[n] * sent[n];
        for (; next < arrivals.size() && arrivals[next].tick <= static_cast<int>(n); ++next)
            receiver.receive(arrivals[next].burst);
        if (changing && n % 97 == 0) receiver.play_out_after(static_cast<std::uint32_t>(n % 50));
        played.waves.push_back(receiver.play(static_cast<std::uint32_t>(n)));
        played.least_J = std::min(played.least_J, stored_J - receiver.energy_out_J());
    }
    played.missing = receiver.missing();
    return played;
}

std::vector<double> some_waves(int kind, std::size_t count, RandomStream& random) {
    std::vector<double> waves(count);
    for (std::size_t k = 0; k < count; ++k) {
        const double t = static_cast<double>(k);
        if (kind == 0) waves[k] = 2 * random.normal();
        if (kind == 1) waves[k] = k % 40 == 0 ? 50 : 0;  // what holding the last one multiplies
        if (kind == 2) waves[k] = 0.5 + 0.4 * std::sin(0.1 * t);
    }
    return waves;
}

TEST(WaveChannel, NoReconstructionButHoldingTheLastGivesOutMoreThanWasSent) {
    double hold_last_J = 0;
    for (std::uint32_t run = 0; run < 60; ++run) {
        RandomStream random({6, 1, run, 1, Purpose::kParameter});
        WaveChannelSettings settings;
        settings.repeats = random.below(WaveBurst::kMost);
        const std::vector<double> waves = some_waves(static_cast<int>(run % 3), 600, random);
        const auto arrivals =
            over_network(settings, waves, static_cast<int>(random.below(60)),
                         static_cast<int>(random.below(30)), 0.4 * random.uniform(), random);
        const std::uint32_t play_out = random.below(100);
        for (std::size_t kind = 0; kind < kWaveReconstructionNames.size(); ++kind) {
            settings.reconstruction = static_cast<WaveReconstruction>(kind);
            const Played played = play(settings, waves, arrivals, play_out, run % 2 == 0);
            if (settings.reconstruction == WaveReconstruction::kHoldLast) {
                hold_last_J = std::min(hold_last_J, played.least_J);
            } else {
                EXPECT_GE(played.least_J, -1e-12) << kWaveReconstructionNames[kind] << " run " << run;
            }
        }
    }
    EXPECT_LT(hold_last_J, -1) << "the networks here are bad enough to tell";
}

// u = 1, then n lost samples of a sender that sends 0.
TEST(WaveChannel, HoldingTheLastOwesHalfATickForEachLostSample) {
    for (const int lost : {1, 5, 50}) {
        WaveChannelSettings settings;
        settings.reconstruction = WaveReconstruction::kHoldLast;
        settings.repeats = 0;
        WaveSender sender(settings);
        WaveReceiver receiver(settings);
        double sent_J = 0;
        for (int k = 0; k < lost + 20; ++k) {
            const double u = k == 0 ? 1 : 0;
            sent_J += 0.5 * kTickWave_s * u * u;
            const WaveBurst burst = sender.add(u);
            if (k == 0 || k > lost) receiver.receive(burst);
            receiver.play(static_cast<std::uint32_t>(k));
        }
        EXPECT_NEAR(receiver.energy_out_J() - sent_J, 0.5 * lost * kTickWave_s, 1e-15) << lost;
    }
}

// In time for delay, jitter and repeats: every wave once, unchanged, however packets come, if no more than r in a row are lost.
TEST(WaveChannel, PlayOutIsLosslessUpToBurstsOfTheRepeats) {
    for (std::uint32_t run = 0; run < 20; ++run) {
        RandomStream random({6, 2, run, 1, Purpose::kParameter});
        WaveChannelSettings settings;
        settings.repeats = 3;
        const std::vector<double> waves = some_waves(0, 500, random);
        auto arrivals = over_network(settings, waves, 50, 5, 0, random);
        std::erase_if(arrivals, [](const Arrival& a) { return a.burst.number % 10 > 6; });  // three in a row
        const Played played = play(settings, waves, arrivals, 50 + 5 + 3);
        EXPECT_EQ(played.missing, 0U);
        for (std::size_t n = 0; n < waves.size(); ++n) EXPECT_EQ(played.waves[n], n < 58 ? 0 : waves[n - 58]);
        std::erase_if(arrivals, [](const Arrival& a) { return a.burst.number % 10 > 5; });  // four
        EXPECT_GT(play(settings, waves, arrivals, 50 + 5 + 3).missing, 40U);
    }
}

TEST(WaveChannel, ASteadyWaveSurvivesPlayOutOnly) {
    RandomStream random({6, 3, 1, 1, Purpose::kParameter});
    const std::vector<double> waves(4000, 0.5);
    std::vector<double> means;
    for (std::size_t kind = 0; kind < kWaveReconstructionNames.size(); ++kind) {
        WaveChannelSettings settings;
        settings.reconstruction = static_cast<WaveReconstruction>(kind);
        const Played played = play(settings, waves, over_network(settings, waves, 20, 5, 0.05, random), 30);
        double sum = 0;
        for (std::size_t n = 2000; n < waves.size(); ++n) sum += played.waves[n] / 2000;
        means.push_back(sum);
    }
    EXPECT_NEAR(means[0], 0.5, 1e-3);  // play-out
    EXPECT_LT(means[2], 0.4);          // zero-fill: what jitter makes late is gone
}

TEST(WaveChannel, BurstsThatCannotBeAreRefused) {
    WaveReceiver receiver({}, 0);
    WaveBurst burst;
    burst.wave_root_W.fill(1);
    burst.number = 2;
    burst.count = 9;  // more than fit
    receiver.receive(burst);
    burst.count = 4;  // from before the first
    receiver.receive(burst);
    burst.count = 3;
    burst.wave_root_W[1] = std::nan("");
    receiver.receive(burst);
    burst.wave_root_W[1] = 1;
    burst.energy_J = kInfinite;
    receiver.receive(burst);
    for (std::uint32_t n = 0; n < 3; ++n) EXPECT_EQ(receiver.play(n), 0);
    EXPECT_EQ(receiver.missing(), 3U);
}

}  // namespace
}  // namespace thimble
