// One datagram, sealed and opened; each counter once.
#include <set>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/unit/security/security_rig.hpp"

namespace thimble {
namespace {

SecretKey counting_key() {
    SecretKey key;
    for (std::size_t i = 0; i < kKeyBytes; ++i) key.bytes[i] = static_cast<std::uint8_t>(i);
    return key;
}

struct Ends {
    Ends() {
        sealer.arm(counting_key());
        opener.arm(counting_key());
    }
    // Its fate at the receiving end.
    bool opens(const Datagram& datagram) {
        const auto header = read_seal_header(datagram);
        return header && opener.knows(*header) && opener.open(*header, datagram, text, counters).has_value();
    }
    Datagram seal(std::string_view text_to_seal) {
        const Bytes bytes = sealer.seal(PacketKind::kData, Port::kSlaveNeedle, bytes_of(text_to_seal));
        return {bytes.begin(), bytes.end()};
    }

    Sealer sealer;
    Opener opener;
    SecurityCounters counters;
    std::array<std::uint8_t, kMaxDatagramBytes> text{};
};

// Computed with another library (Python's cryptography, and hashlib for the key's name).
TEST(Sealing, IsChaCha20Poly1305WithTheCounterAsNonceAndTheHeaderAuthenticated) {
    Ends ends;
    EXPECT_EQ(hex(ends.seal("needle")),
              "5431010e497960810100000000000000f132963bd94ffab21c925a522480ef5d453908f9e1a6");
}

TEST(Sealing, WhatWasSealedOpens) {
    Ends ends;
    ASSERT_TRUE(ends.opens(ends.seal("needle")));
    EXPECT_EQ(std::string(ends.text.begin(), ends.text.begin() + 6), "needle");
    EXPECT_EQ(ends.counters.opened, 1U);
}

TEST(Sealing, AChangedCutOrLengthenedDatagramIsRefused) {
    Ends ends;
    const Datagram good = ends.seal("a needle command");
    for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
        Datagram bad = good;
        bad[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
        EXPECT_FALSE(ends.opens(bad)) << "bit " << bit;
    }
    EXPECT_GT(ends.counters.forged, 8U * 16);
    for (std::size_t size = 0; size <= kMaxDatagramBytes + 1; ++size) {
        Datagram resized = good;
        resized.resize(size);
        EXPECT_EQ(ends.opens(resized), size == good.size())
            << size;  // none of those before has moved the window
    }
}

// The hop adds a code to a sealed datagram, and does not encrypt it again.
TEST(Sealing, AHopIsReadableAndNoBitOfItCanBeChanged) {
    Ends ends;
    const Bytes bytes = ends.sealer.seal(PacketKind::kHop, Port::kNetemNeedle, bytes_of("sealed before"));
    const Datagram good(bytes.begin(), bytes.end());
    EXPECT_EQ(good.size(), std::string_view("sealed before").size() + kSealOverheadBytes);
    EXPECT_EQ(std::string(good.begin() + kSealHeaderBytes, good.end() - kSealTagBytes), "sealed before");
    for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
        Datagram bad = good;
        bad[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
        EXPECT_FALSE(ends.opens(bad)) << "bit " << bit;
    }
    for (std::size_t size = 0; size < good.size(); ++size)
        EXPECT_FALSE(ends.opens({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)})) << size;
    EXPECT_TRUE(ends.opens(good));
    EXPECT_EQ(std::string(ends.text.begin(), ends.text.begin() + 13), "sealed before");
}

TEST(Sealing, EachDatagramOpensOnce) {
    Ends ends;
    const Datagram first = ends.seal("1"), second = ends.seal("2");
    EXPECT_TRUE(ends.opens(second));
    EXPECT_TRUE(ends.opens(first));  // overtaken on the way
    EXPECT_FALSE(ends.opens(first));
    EXPECT_FALSE(ends.opens(second));
    EXPECT_EQ(ends.counters.replayed, 2U);
}

TEST(Sealing, TheLongestTextIsSealedAndALongerOneIsNot) {
    Ends ends;
    EXPECT_EQ(ends.seal(std::string(kMaxSealedTextBytes, 'x')).size(), kMaxDatagramBytes);
    EXPECT_TRUE(ends.seal(std::string(kMaxSealedTextBytes + 1, 'x')).empty());
    ends.sealer.disarm();
    EXPECT_TRUE(ends.seal("x").empty());
}

TEST(ReplayWindow, KnowsNoCounterBeforeTheFirst) {
    EXPECT_FALSE(ReplayWindow{}.is_fresh(0));
    EXPECT_TRUE(ReplayWindow{}.is_fresh(1));
}

TEST(ReplayWindow, EndsWhereItSays) {
    constexpr std::uint64_t kNewest = 100'000;
    ReplayWindow window;
    window.accept(kNewest);
    EXPECT_FALSE(window.is_fresh(0));
    EXPECT_FALSE(window.is_fresh(kNewest));
    EXPECT_TRUE(window.is_fresh(kNewest + 1));
    EXPECT_TRUE(window.is_fresh(kNewest - ReplayWindow::kReach + 1));
    EXPECT_FALSE(window.is_fresh(kNewest - ReplayWindow::kReach));
    EXPECT_TRUE(window.is_fresh(~std::uint64_t{0}));
}

// Against a set that remembers everything: never twice, and nothing within reach is refused without reason.
RC_GTEST_PROP(ReplayWindow, IsASetWithinItsReach, ()) {
    ReplayWindow window;
    std::set<std::uint64_t> seen;
    std::uint64_t newest = 0, base = 1;
    for (int i = 0; i < 300; ++i) {
        const auto jump = *rc::gen::weightedOneOf<std::uint64_t>(
            {{30, rc::gen::inRange<std::uint64_t>(0, 8)}, {1, rc::gen::inRange<std::uint64_t>(0, 5000)}});
        base += jump;
        const auto back = *rc::gen::inRange<std::uint64_t>(0, 2100);
        const std::uint64_t counter = base > back ? base - back : base;
        const bool within = counter > newest || newest - counter < ReplayWindow::kReach;
        RC_ASSERT(window.is_fresh(counter) == (within && seen.count(counter) == 0));
        if (!window.is_fresh(counter)) continue;
        window.accept(counter);
        seen.insert(counter);
        newest = std::max(newest, counter);
    }
}

}  // namespace
}  // namespace thimble
