#include "common/security/stop_seal.hpp"

#include <gtest/gtest.h>

#include "common/codec.hpp"
#include "tests/unit/security/security_rig.hpp"

namespace thimble {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

// Two programs on a stop line, each with its own clock and lab key.
struct StopRig {
    std::int64_t here_ns = 1000 * kSecond_ns, there_ns = 1000 * kSecond_ns;
    TestPipe pipe;
    StopSeal here{pipe.a, test_lab_key(), [this] { return here_ns; }};
    StopSeal there{pipe.b, test_lab_key(), [this] { return there_ns; }};
    Encoder encoder;

    Datagram order(StopKind kind) {
        Header header;
        header.sender = Role::kExperimenter;
        const Bytes bytes = encoder.encode(header, StopOrder(5, kind, EndReason::kEmergencyStop, "smoke"));
        return {bytes.begin(), bytes.end()};
    }
    bool arrives(StopKind kind) {
        const Datagram sent = order(kind);
        here.send(sent);
        const Bytes got = there.receive();
        return std::equal(got.begin(), got.end(), sent.begin(), sent.end());
    }
};

TEST(StopSeal, CarriesStopsAndReleases) {
    StopRig rig;
    EXPECT_TRUE(rig.arrives(StopKind::kStop));
    EXPECT_TRUE(rig.arrives(StopKind::kRelease));
    EXPECT_EQ(rig.there.counters().opened, 2U);
}

TEST(StopSeal, EveryFlippedBitIsRefused) {
    StopRig rig;
    ASSERT_TRUE(rig.arrives(StopKind::kRelease));
    const Datagram good = rig.pipe.a.said.back();
    for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
        Datagram bad = good;
        bad[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
        rig.pipe.b.deliver(bad);
        EXPECT_TRUE(rig.there.receive().empty()) << bit;
    }
    for (std::size_t size = 0; size < good.size(); ++size) {
        rig.pipe.b.deliver(Datagram(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)));
        EXPECT_TRUE(rig.there.receive().empty()) << size;
    }
    EXPECT_EQ(rig.there.counters().opened, 1U);
}

TEST(StopSeal, AnotherLabsStopIsNone) {
    StopRig rig;
    StopSeal stranger(rig.pipe.a, test_lab_key(8), [] { return 1000 * kSecond_ns; });
    stranger.send(rig.order(StopKind::kStop));
    EXPECT_TRUE(rig.there.receive().empty());
    rig.pipe.b.deliver(rig.order(StopKind::kStop));  // in the clear
    EXPECT_TRUE(rig.there.receive().empty());
    EXPECT_EQ(rig.there.counters().forged, 1U);
    EXPECT_EQ(rig.there.counters().unsealed, 1U);
}

TEST(StopSeal, ARecordedReleaseLetsGoOfNothing) {
    for (const std::int64_t off_s : {61, -61}) {
        StopRig rig;
        rig.there_ns += off_s * kSecond_ns;
        EXPECT_FALSE(rig.arrives(StopKind::kRelease)) << off_s;
        EXPECT_EQ(rig.there.counters().replayed, 1U);
        EXPECT_TRUE(rig.arrives(StopKind::kStop)) << "whatever the clocks say";
        rig.there_ns = rig.here_ns + off_s / 2 * kSecond_ns;
        EXPECT_TRUE(rig.arrives(StopKind::kRelease));
    }
}

}  // namespace
}  // namespace thimble
