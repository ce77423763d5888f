// A fit gives back what a path was made with, and says when nothing offered fits.
#include "netem/formats/path_fit.hpp"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/random.hpp"
#include "netem/profiles/profiles.hpp"
#include "netem/stages/delay_shape.hpp"
#include "tests/refusal.hpp"
#include "tests/unit/netem/statistics_tools.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using testing::Contains;
using testing::HasSubstr;

constexpr int kPackets = 20'000;

// The same link, out of the profile that is written of it.
LinkSettings read_back(const LinkSettings& link) {
    const auto no_files = [](std::string_view) { return std::string(); };
    return parse_profile(print_profile({"", "", {}, link, link, {}, {}}), "lab.toml", no_files).up;
}

// An AR(1) Gaussian through the shape's quantile function, drawn here and not by the link under test.
MeasuredPath path_with(const JitterSettings& jitter, Duration delay, std::uint64_t seed) {
    RandomStream random(StreamKey{.study = seed});
    const DelayShape shape(jitter, delay);
    MeasuredPath path;
    path.has_delay = path.has_loss = true;
    double z = random.normal();
    for (int i = 0; i < kPackets; ++i) {
        const double delay_s = to_seconds(delay) + to_seconds(jitter.spread) * shape.at_normal(z);
        path.packets.push_back({i * std::int64_t{1'000'000}, from_seconds(std::max(0.0, delay_s)), 0, 0});
        z = jitter.correlation * z + std::sqrt(1 - jitter.correlation * jitter.correlation) * random.normal();
    }
    return path;
}

TEST(PathFit, FindsTheShapeItsSpreadAndCorrelation) {
    for (const JitterShape shape : {JitterShape::kUniform, JitterShape::kNormal, JitterShape::kGamma,
                                    JitterShape::kPareto, JitterShape::kParetoNormal}) {
        for (const double correlation : {0.0, 0.5}) {
            const JitterSettings jitter{shape, milliseconds{8}, correlation};
            const PathFit fit = fit_path(path_with(jitter, milliseconds{30}, 5));
            EXPECT_EQ(fit.link.jitter.shape, shape) << correlation;
            EXPECT_NEAR(to_seconds(fit.link.delay), 0.030, 0.0005);
            EXPECT_NEAR(to_seconds(fit.link.jitter.spread), 0.008, 0.0008) << static_cast<int>(shape);
            EXPECT_NEAR(fit.link.jitter.correlation, correlation, 0.03) << static_cast<int>(shape);
            EXPECT_LT(fit.shapes[0].distance, 0.03);
            EXPECT_LT(fit.shapes[0].distance, fit.shapes[1].distance);
        }
    }
}

template <class DelayOf>
MeasuredPath delayed_path(int packets, const DelayOf& delay_of) {
    MeasuredPath path;
    path.has_delay = true;
    for (int i = 0; i < packets; ++i) path.packets.push_back({i, delay_of(i), 0, 0});
    return path;
}

// 1 kHz with a jitter of many periods: nearly every packet overtakes or is overtaken.
TEST(PathFit, KeepsReorderingAndOrder) {
    MeasuredPath path = path_with({JitterShape::kNormal, milliseconds{8}, 0}, milliseconds{50}, 5);
    const PathFit overtaking = fit_path(path);
    EXPECT_FALSE(overtaking.link.in_order);
    EXPECT_NEAR(static_cast<double>(overtaking.reordered), static_cast<double>(overtaking.would_overtake),
                300);
    EXPECT_THAT(overtaking.sentences, Contains(HasSubstr("lets packets overtake each other")));
    EXPECT_FALSE(read_back(overtaking.link).in_order);
    std::int64_t latest = 0;
    for (MeasuredPacket& packet : path.packets) {
        latest = std::max(latest, packet.at + packet.delay->count());
        packet.delay = Duration{latest - packet.at};
    }
    const PathFit in_order = fit_path(path);
    EXPECT_TRUE(in_order.link.in_order);
    EXPECT_EQ(in_order.reordered, 0U);
}

TEST(PathFit, SaysWhenNoShapeIsLikeIt) {
    const auto path = delayed_path(1000, [](int i) { return milliseconds{i % 2 == 0 ? 10 : 40}; });
    const PathFit fit = fit_path(path);
    EXPECT_GT(fit.shapes[0].distance, 0.2);
    EXPECT_THAT(fit.sentences, Contains(HasSubstr("which is poor")));
    EXPECT_LT(fit.correlation, -0.9);  // it alternates
    EXPECT_EQ(fit.link.jitter.correlation, 0);
    std::vector<double> squares = standardised_delays(path);
    for (double& deviate : squares) deviate *= deviate;
    EXPECT_NEAR(test::mean_of(squares), 1, 0.01);
}

TEST(PathFit, OffersNoShapeThatWouldBeCutAtZero) {
    RandomStream random(StreamKey{.study = 9});
    const PathFit fit = fit_path(delayed_path(2000, [&](int) {
        return from_seconds(-0.01 * std::log(1 - random.uniform()));  // spread = mean
    }));
    EXPECT_EQ(fit.link.jitter.shape, JitterShape::kGamma);
    for (const ShapeFit& shape : fit.shapes)
        EXPECT_TRUE(shape.shape == JitterShape::kGamma || shape.shape == JitterShape::kPareto);
    EXPECT_EQ(read_back(fit.link), fit.link);
}

TEST(PathFit, AConstantDelayHasNoJitter) {
    const auto path = delayed_path(10, [](int) { return milliseconds{10}; });
    const PathFit fit = fit_path(path);
    EXPECT_EQ(fit.link.jitter, JitterSettings{});
    EXPECT_EQ(fit.link.delay, milliseconds{10});
    EXPECT_THAT(fit.sentences, Contains(HasSubstr("does not vary")));
    EXPECT_THROW(standardised_delays(path), Error);
}

MeasuredPath lossy(double good_to_bad, double bad_to_good, std::uint64_t seed) {
    RandomStream random(StreamKey{.study = seed});
    MeasuredPath path;
    path.has_loss = true;
    bool lost = false;
    for (int i = 0; i < kPackets; ++i) {
        lost = lost ? random.uniform() >= bad_to_good : random.uniform() < good_to_bad;
        path.packets.push_back({i, {}, lost ? 1.0 : 0.0, 0});
    }
    return path;
}

TEST(PathFit, FindsGilbertsParameters) {
    const PathFit fit = fit_path(lossy(0.01, 0.25, 1));
    ASSERT_EQ(fit.link.loss.shape, LossShape::kGilbertElliott);
    // Four standard errors of a share among n0 and n1 packets.
    EXPECT_NEAR(fit.link.loss.good_to_bad, 0.01, 4 * std::sqrt(0.01 / kPackets));
    EXPECT_NEAR(fit.link.loss.bad_to_good, 0.25, 4 * std::sqrt(0.25 * 0.75 / (kPackets * 0.038)));
    EXPECT_NEAR(stationary_loss(fit.link.loss), static_cast<double>(fit.lost) / kPackets, 0.001);
    EXPECT_NEAR(fit.mean_burst, 4, 0.5);
    EXPECT_THAT(fit.sentences, Contains(HasSubstr("in bursts")));
}

TEST(PathFit, IndependentLossIsNotMistakenForBursts) {
    int bursts = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const PathFit fit = fit_path(lossy(0.02, 0.98, seed));
        bursts += fit.link.loss.shape == LossShape::kGilbertElliott ? 1 : 0;
        EXPECT_NEAR(stationary_loss(fit.link.loss), 0.02, 4 * std::sqrt(0.02 / kPackets));
    }
    EXPECT_LE(bursts, 1);  // one in a thousand by chance
}

// "received" and "lost" so many times, in turn.
MeasuredPath runs_of(std::initializer_list<int> runs) {
    MeasuredPath path;
    path.has_loss = true;
    bool lost = false;
    for (const int run : runs) {
        for (int i = 0; i < run; ++i)
            path.packets.push_back({static_cast<std::int64_t>(path.packets.size()), {}, lost ? 1.0 : 0.0, 0});
        lost = !lost;
    }
    return path;
}

// The path cuts off such a burst. The fit keeps its share and its length.
TEST(PathFit, ABurstAtAnEndOfThePathIsKept) {
    for (const auto& [path, where] :
         {std::pair{runs_of({0, 5, 100}), "at its beginning"}, std::pair{runs_of({100, 5}), "at its end"}}) {
        const PathFit fit = fit_path(path);
        ASSERT_EQ(fit.link.loss.shape, LossShape::kGilbertElliott);
        EXPECT_NEAR(stationary_loss(fit.link.loss), 5.0 / 105, 1e-12);
        EXPECT_NEAR(mean_loss_burst(fit.link.loss), 5, 1e-9);
        EXPECT_THAT(fit.sentences, Contains(HasSubstr(where)));
        for (const std::string& sentence : fit.sentences) {
            EXPECT_THAT(sentence, testing::Not(testing::ContainsRegex("nan|inf|-0"))) << sentence;
        }
        const LossSettings read = read_back(fit.link).loss;
        EXPECT_NEAR(stationary_loss(read), 5.0 / 105, 1e-12);
        EXPECT_NEAR(mean_loss_burst(read), 5, 1e-9);
    }
}

// The program can read every profile that it has fitted.
TEST(PathFit, WhatItFitsCanBeRead) {
    for (const int received : {0, 1, 40}) {
        for (const int lost : {1, 2, 30}) {
            for (const int again : {0, 1, 50}) {
                for (const int end : {0, 1, 20}) {
                    const MeasuredPath path = runs_of({received, lost, again, end});
                    if (path.packets.size() < 2) continue;
                    const PathFit fit = fit_path(path);
                    const LinkSettings read = read_back(fit.link);
                    const double share = static_cast<double>(fit.lost) / static_cast<double>(fit.packets);
                    const double factor = share > 0 ? stationary_loss(read.loss) / share : 1;
                    EXPECT_TRUE(factor > 0.5 && factor < 2)
                        << factor << ": " << received << ' ' << lost << ' ' << again << ' ' << end;
                }
            }
        }
    }
}

TEST(PathFit, NoLossIsABoundAndTooLittleIsRefused) {
    MeasuredPath path = runs_of({300});
    EXPECT_THAT(fit_path(path).sentences, Contains(HasSubstr("less than 1 % is (95 % confidence)")));
    path.packets[7].loss = 0.2;  // of a profile's trace
    EXPECT_THAT(refusal([&] { require_fates(path, "leo.csv"); }, ExitCode::kData),
                HasSubstr("probabilities (such as 0.2)"));
    path.packets.resize(1);
    EXPECT_THROW(fit_path(path), Error);
}

}  // namespace
}  // namespace thimble
