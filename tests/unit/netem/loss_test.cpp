// Loss: as much as asked, in bursts as long as asked.
#include "netem/stages/loss.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/netem/link_test_tools.hpp"

namespace thimble::test {
namespace {

constexpr std::uint64_t kLongRun = 1'000'000;

struct Tally {
    double share = 0, mean_burst = 0;
    std::uint64_t bursts = 0;
};

Tally tally(const LossSettings& settings) {
    Loss loss(kKey, 1);
    loss.configure(settings);
    std::uint64_t lost = 0;
    std::uint64_t bursts = 0;
    bool before = false;
    for (std::uint64_t packet = 0; packet < kLongRun; ++packet) {
        const bool now = loss.lost(packet);
        lost += now ? 1 : 0;
        bursts += now && !before ? 1 : 0;
        before = now;
    }
    return {static_cast<double>(lost) / kLongRun, static_cast<double>(lost) / static_cast<double>(bursts),
            bursts};
}

// Bernoulli trials with an autocorrelation of lambda^k spread by (1 + lambda) / (1 - lambda) more.
double sd_of_share(double share, double lambda) {
    return std::sqrt(share * (1 - share) / kLongRun * (1 + lambda) / (1 - lambda));
}

TEST(Loss, IndependentLosesWhatWasAsked) {
    for (const double asked : {1e-4, 0.01, 0.3}) {
        const Tally found = tally(LossSettings::independent(asked));
        EXPECT_NEAR(found.share, asked, 3 * sd_of_share(asked, 0)) << asked;
        EXPECT_NEAR(
            found.mean_burst, 1 / (1 - asked),
            4 * std::sqrt(asked / (1 - asked) / (1 - asked) / static_cast<double>(found.bursts)) + 1e-12);
    }
}

// Lengths of bursts are geometric: SD sqrt(1 - r) / r, with r the chance to end.
TEST(Loss, GilbertHasTheAskedShareAndBursts) {
    struct Case {
        double share, burst;
    };
    for (const Case& asked : {Case{0.001, 3}, Case{0.01, 1.5}, Case{0.05, 10}, Case{0.5, 4}}) {
        const LossSettings settings = LossSettings::gilbert(asked.share, asked.burst);
        EXPECT_NEAR(stationary_loss(settings), asked.share, 1e-15);
        EXPECT_NEAR(mean_loss_burst(settings), asked.burst, 1e-12);
        const Tally found = tally(settings);
        const double lambda = 1 - settings.good_to_bad - settings.bad_to_good;
        EXPECT_NEAR(found.share, asked.share, 3 * sd_of_share(asked.share, lambda)) << asked.share;
        const double sd = std::sqrt(1 - settings.bad_to_good) * asked.burst;
        EXPECT_NEAR(found.mean_burst, asked.burst, 4 * sd / std::sqrt(static_cast<double>(found.bursts)));
    }
}

// `lambda`: the autocorrelation of the chain's state, or more.
void expect_stationary(const LossSettings& settings, double lambda) {
    const double share = stationary_loss(settings);
    const Tally found = tally(settings);
    EXPECT_NEAR(found.share, share, 3 * sd_of_share(share, lambda));
    EXPECT_NEAR(found.mean_burst, mean_loss_burst(settings), 0.02);
}

TEST(Loss, GilbertElliottHasItsStationaryShareAndBursts) {
    const LossSettings settings{.shape = LossShape::kGilbertElliott,
                                .good_to_bad = 0.02,
                                .bad_to_good = 0.2,
                                .loss_in_good = 0.01,
                                .loss_in_bad = 0.6};
    EXPECT_NEAR(stationary_loss(settings), 0.01 + (0.02 / 0.22) * 0.59, 1e-15);
    expect_stationary(settings, 0.78);
}

TEST(Loss, FourStatesHaveTheirStationaryShareAndBursts) {
    const LossSettings settings{
        .shape = LossShape::kFourState, .p13 = 0.01, .p31 = 0.15, .p32 = 0.35, .p23 = 0.4, .p14 = 0.005};
    const auto shares = four_state_shares(settings);
    EXPECT_NEAR(shares[0] + shares[1] + shares[2] + shares[3], 1, 1e-15);
    // Balance of each state.
    EXPECT_NEAR(shares[0] * (settings.p13 + settings.p14), shares[2] * settings.p31 + shares[3], 1e-15);
    EXPECT_NEAR(shares[1] * settings.p23, shares[2] * settings.p32, 1e-15);
    EXPECT_NEAR(shares[0] * settings.p14, shares[3], 1e-15);
    EXPECT_NEAR(stationary_loss(settings), shares[2] + shares[3], 1e-15);
    expect_stationary(settings, 0.9);
}

// Over many trials the very first packet is lost as often as any.
TEST(Loss, ChainsStartStationary) {
    const LossSettings four{.shape = LossShape::kFourState, .p13 = 0.02, .p31 = 0.05, .p14 = 0.1};
    for (const LossSettings& settings : {LossSettings::gilbert(0.3, 50), four}) {
        constexpr std::uint32_t kTrials = 20'000;
        std::uint32_t lost = 0;
        for (std::uint32_t trial = 0; trial < kTrials; ++trial) {
            StreamKey key = kKey;
            key.trial = trial;
            Loss loss(key, 1);
            loss.configure(settings);
            lost += loss.lost(0) ? 1U : 0U;
        }
        const double share = stationary_loss(settings);
        EXPECT_NEAR(static_cast<double>(lost) / kTrials, share, 4 * std::sqrt(share * (1 - share) / kTrials));
    }
}

TEST(Loss, MeanBurstsOfTheExtremes) {
    EXPECT_EQ(mean_loss_burst({}), 0);
    EXPECT_TRUE(std::isinf(mean_loss_burst(LossSettings::independent(1))));
    EXPECT_EQ(stationary_loss(LossSettings::gilbert(0, 3)), 0);
}

TEST(Loss, ChangedChainsStartAnewAndUnchangedGoOn) {
    const LossSettings settings = LossSettings::gilbert(0.3, 10);
    Loss reference(kKey, 1);
    Loss told_again(kKey, 1);
    Loss changed(kKey, 1);
    for (Loss* loss : {&reference, &told_again, &changed}) loss->configure(settings);
    int different = 0;
    for (std::uint64_t packet = 0; packet < 5000; ++packet) {
        if (packet == 100) told_again.configure(settings);
        if (packet == 100) changed.configure(LossSettings::gilbert(0.3, 2));
        const bool expected = reference.lost(packet);
        ASSERT_EQ(told_again.lost(packet), expected);
        different += changed.lost(packet) != expected;
    }
    EXPECT_GT(different, 100);
}

}  // namespace
}  // namespace thimble::test
