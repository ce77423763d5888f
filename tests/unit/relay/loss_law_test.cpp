// The exact law of a number of losses, against closed forms and against thousands of links.
#include "netem/relay/loss_law.hpp"

#include <cmath>

#include <boost/math/distributions/binomial.hpp>
#include <gtest/gtest.h>

#include "netem/link_model.hpp"
#include "netem/packet_trace.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::size_t kPacketsSent = 4000;

std::vector<SessionTime> each_millisecond(std::size_t packets = kPacketsSent) {
    std::vector<SessionTime> times;
    for (std::size_t i = 0; i < packets; ++i) times.emplace_back(milliseconds{i});
    return times;
}

TwinLink losing(const LossSettings& loss) {
    TwinLink link;
    link.settings.loss = loss;
    return link;
}

TEST(LossLaw, IsBinomialForIndependentLosses) {
    for (const double share : {1e-5, 0.01, 0.3}) {
        const LossLaw law(losing(LossSettings::independent(share)), each_millisecond());
        const boost::math::binomial binomial(kPacketsSent, share);
        EXPECT_NEAR(law.mean(), kPacketsSent * share, 1e-9 * kPacketsSent);
        for (const double deviations : {-6.0, -3.0, 0.0, 1.0, 4.0, 7.0}) {
            const double lost = std::round(kPacketsSent * share +
                                           deviations * std::sqrt(kPacketsSent * share * (1 - share)) + 0.2);
            if (lost < 0) continue;
            const double so_few = cdf(binomial, lost);
            const double so_many = lost == 0 ? 1 : cdf(complement(binomial, lost - 1));
            const double chance = std::min(1.0, 2 * std::min(so_few, so_many));
            EXPECT_NEAR(law.chance_of(static_cast<std::uint64_t>(lost)), chance, 1e-9 * chance + 1e-20)
                << share << ' ' << lost;
        }
    }
}

TEST(LossLaw, WithoutLossNothingMayBeLost) {
    const LossLaw law(losing({}), each_millisecond());
    EXPECT_EQ(law.chance_of(0), 1);
    EXPECT_EQ(law.chance_of(1), 0);
    EXPECT_EQ(LossLaw(losing(LossSettings::independent(1)), each_millisecond()).chance_of(kPacketsSent), 1);
}

// Two packets: each way through the chain by hand.
TEST(LossLaw, FollowsAChainStepByStep) {
    const LossSettings loss = LossSettings::gilbert(0.2, 4);  // to bad 1/16, back 1/4
    const LossLaw law(losing(loss), each_millisecond(2));
    EXPECT_NEAR(law.mean(), 0.4, 1e-12);
    const double none = 0.8 * 15 / 16, both = 0.2 * 3 / 4;
    EXPECT_NEAR(law.chance_of(0), 1, 1e-12);  // the more likely side
    EXPECT_NEAR(law.chance_of(2), 2 * both, 1e-12);
    EXPECT_NEAR(law.chance_of(1), std::min(1.0, 2 * (1 - none)), 1e-12);
}

LossSettings four_states() {
    return {.shape = LossShape::kFourState, .p13 = 0.01, .p31 = 0.2, .p32 = 0.3, .p23 = 0.4, .p14 = 0.005};
}

TwinLink changing() {
    TwinLink link = losing(LossSettings::gilbert(0.02, 5));
    link.timeline = {{seconds{1}, {.loss = LossSettings::independent(0.1)}},
                     {seconds{3}, {.loss = four_states()}}};
    return link;
}

TwinLink traced() {
    TwinLink link;
    link.settings.trace = std::make_shared<PacketTrace>(
        std::vector<TraceRow>{{.at = 0, .loss = 0.001}, {.at = 1'000'000'000, .loss = 0.05}},
        TraceLayout{.has_loss = true});
    return link;
}

std::uint64_t lost_by(TwinLink link, std::uint64_t seed, const std::vector<SessionTime>& times) {
    link.key.study = seed;
    LinkModel model(link.settings, link.key, link.direction, link.timeline, link.start);
    const std::array<std::uint8_t, 1> datagram{};
    for (const SessionTime now : times) {
        model.push(now, datagram);
        while (model.next_due() <= now) model.pop_due(now);
    }
    return model.counters().lost;
}

// The share of seeds that is called rare is the share that is promised, for each kind of loss.
TEST(LossLaw, IsTheLawOfTheLinks) {
    constexpr int kSeeds = 1000;
    const auto times = each_millisecond();
    for (const TwinLink& link :
         {losing(LossSettings::independent(1e-5)), losing(LossSettings::gilbert(0.002, 3)),
          losing(four_states()), changing(), traced()}) {
        const LossLaw law(link, times);
        double sum = 0;
        int rare = 0;
        for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
            const std::uint64_t lost = lost_by(link, seed, times);
            sum += static_cast<double>(lost);
            const double chance = law.chance_of(lost);
            EXPECT_GT(chance, 1e-6) << seed;
            rare += chance < 0.05 ? 1 : 0;
        }
        // Bursts of 5 at most: a variance of 10 times the mean, or less.
        EXPECT_NEAR(sum / kSeeds, law.mean(), 4 * std::sqrt(10 * law.mean() / kSeeds));
        EXPECT_LE(rare, kSeeds * 0.05 + 4 * std::sqrt(kSeeds * 0.05 * 0.95));
        const bool common =
            law.mean() > 5;  // else few numbers are possible, and those that are rare are rarer
        EXPECT_GE(rare, common ? kSeeds * 0.02 : 0);
    }
}

}  // namespace
}  // namespace thimble
