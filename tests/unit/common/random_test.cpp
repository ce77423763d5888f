#include "common/random.hpp"

#include <array>
#include <cmath>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace thimble {
namespace {

using Words = std::array<std::uint32_t, 4>;

// Known answers published with the generator (Random123, kat_vectors, philox4x32 with 10 rounds).
TEST(Philox, KnownAnswers) {
    EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
    constexpr std::uint32_t kOnes = 0xffffffff;
    EXPECT_EQ(philox({kOnes, kOnes, kOnes, kOnes}, {kOnes, kOnes}),
              (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
    EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
              (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

constexpr StreamKey kKey{12, 3, 4, 5, Purpose::kReaction};

// Part of every published seed: these may never change.
TEST(RandomStream, FirstNumbersOfAStream) {
    RandomStream stream(kKey);
    EXPECT_EQ(stream(), 0xde3a544088d73b8eU);
    EXPECT_EQ(stream(), 0x073d542e771754b0U);
    EXPECT_EQ(stream(), 0xb59661ab472bffcfU);
}

TEST(RandomStream, SeekGoesWhereCountingGoes) {
    RandomStream counted(kKey);
    std::vector<std::uint64_t> numbers;
    for (int i = 0; i < 20; ++i) numbers.push_back(counted());
    for (const std::uint64_t start : {0U, 1U, 2U, 7U, 16U, 3U}) {
        RandomStream sought(kKey);
        sought();  // whatever was drawn before
        sought.seek(start);
        for (std::uint64_t i = start; i < numbers.size(); ++i) ASSERT_EQ(sought(), numbers[i]) << start;
    }
}

TEST(RandomStream, SeekReachesBeyondTheLowWordOfTheCounter) {
    RandomStream far(kKey), near(kKey);
    far.seek(std::uint64_t{1} << 33);
    EXPECT_NE(far(), near());
    RandomStream one_less(kKey);
    one_less.seek((std::uint64_t{1} << 33) - 1);
    one_less();
    far.seek(std::uint64_t{1} << 33);
    EXPECT_EQ(far(), one_less());
}

TEST(RandomStream, EveryPartOfTheKeyMakesAnotherStream) {
    const std::vector<StreamKey> keys{
        kKey,
        {13, 3, 4, 5, Purpose::kReaction},
        {12 + (std::uint64_t{1} << 40), 3, 4, 5, Purpose::kReaction},
        {12, 2, 4, 5, Purpose::kReaction},
        {12, 4, 3, 5, Purpose::kReaction},  // swapped
        {12, 3, 5, 5, Purpose::kReaction},
        {12, 3, 4, 6, Purpose::kReaction},
        {12, 3, 5, 4, Purpose::kReaction},  // swapped
        {12, 3, 4, 5, Purpose::kSpeed},
        {12, 3, 4, 4, static_cast<Purpose>(5)},  // trial and purpose swapped
    };
    std::set<std::uint64_t> first;
    for (const StreamKey& key : keys) first.insert(RandomStream(key)());
    EXPECT_EQ(first.size(), keys.size());
}

// Neighbours in subject and trial draw numbers that have nothing to do with each other.
TEST(RandomStream, NeighboursAreUncorrelated) {
    constexpr int kNumbers = 20'000;
    for (const StreamKey& other :
         {StreamKey{12, 3, 4, 6, Purpose::kReaction}, StreamKey{12, 3, 5, 5, Purpose::kReaction},
          StreamKey{12, 3, 4, 5, Purpose::kSpeed}}) {
        RandomStream a(kKey), b(other);
        double sum = 0;
        for (int i = 0; i < kNumbers; ++i) sum += a.normal() * b.normal();
        EXPECT_LT(std::fabs(sum) / std::sqrt(kNumbers), 4.0);
    }
}

constexpr int kMany = 200'000;

TEST(RandomStream, UniformCoversTheCircleEvenly) {
    RandomStream stream(kKey);
    std::array<int, 64> bins{};
    for (int i = 0; i < kMany; ++i) ++bins[static_cast<std::size_t>(stream.uniform() * bins.size())];
    double chi2 = 0;
    const double expected = static_cast<double>(kMany) / static_cast<double>(bins.size());
    for (const int bin : bins) chi2 += (bin - expected) * (bin - expected) / expected;
    EXPECT_LT(chi2, 120.0);  // 63 degrees of freedom: P < 2e-5
    EXPECT_GT(chi2, 25.0);   // and not suspiciously even
    for (int i = 0; i < 1000; ++i) {
        const double x = stream.uniform(-3, -1);
        EXPECT_GE(x, -3);
        EXPECT_LT(x, -1);
    }
}

TEST(RandomStream, NormalMomentsAndTails) {
    RandomStream stream(kKey);
    std::array<double, 4> moments{};
    int beyond_one = 0, beyond_three = 0;
    for (int i = 0; i < kMany; ++i) {
        const double x = stream.normal();
        beyond_one += std::fabs(x) > 1;
        beyond_three += std::fabs(x) > 3;
        double power = 1;
        for (double& moment : moments) moment += (power *= x) / kMany;
    }
    EXPECT_NEAR(moments[0], 0, 5 / std::sqrt(kMany));
    EXPECT_NEAR(moments[1], 1, 5 * std::sqrt(2.0 / kMany));
    EXPECT_NEAR(moments[2], 0, 5 * std::sqrt(15.0 / kMany));
    EXPECT_NEAR(moments[3], 3, 5 * std::sqrt(96.0 / kMany));
    EXPECT_NEAR(beyond_one, 0.317311 * kMany, 5 * std::sqrt(0.317 * 0.683 * kMany));
    EXPECT_NEAR(beyond_three, 0.0026998 * kMany, 5 * std::sqrt(0.0027 * kMany));
}

TEST(RandomStream, BelowIsUnbiased) {
    RandomStream stream(kKey);
    EXPECT_EQ(stream.below(1), 0U);
    for (const std::uint32_t n : {2U, 3U, 7U, 24U}) {
        std::vector<int> counts(n, 0);
        constexpr int kDraws = 60'000;
        for (int i = 0; i < kDraws; ++i) ++counts.at(stream.below(n));
        const double expected = static_cast<double>(kDraws) / n;
        for (const int count : counts) EXPECT_NEAR(count, expected, 5 * std::sqrt(expected)) << n;
    }
    // Three quarters of the words: a modulo of 32 bits would hit the lowest third twice as often.
    constexpr std::uint32_t kThree = 3U << 30;
    int low = 0;
    constexpr int kDraws = 30'000;
    for (int i = 0; i < kDraws; ++i) low += stream.below(kThree) < (1U << 30);
    EXPECT_NEAR(low, kDraws / 3.0, 5 * std::sqrt(kDraws * 2.0 / 9));
}

}  // namespace
}  // namespace thimble
