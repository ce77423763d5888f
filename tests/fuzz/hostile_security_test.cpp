// The same checks as the fuzzers', on seeded scripts, in every build.
#include <vector>

#include <gtest/gtest.h>

#include "common/random.hpp"
#include "tests/fuzz/security_check.hpp"
#include "tests/fuzz/stop_check.hpp"
#include "tests/unit/security/security_rig.hpp"

namespace thimble {
namespace {

TEST(HostileSecurity, RandomScriptsOnTheHandshake) {
    RandomStream random({3, 0, 0, 0, Purpose::kInstance});
    int established = 0;
    for (int i = 0; i < 300; ++i) {
        std::vector<std::uint8_t> script(random.below(200));
        for (std::uint8_t& byte : script) byte = static_cast<std::uint8_t>(random());
        const Verdict verdict = check_handshake_bytes(script);
        EXPECT_EQ(verdict.flaw, "") << i;
        if (verdict.accepted) ++established;
    }
    EXPECT_GT(established, 50);  // the scripts get somewhere
}

TEST(HostileSecurity, ChangedDatagramsAndWordsAboutKeys) {
    RandomStream random({4, 0, 0, 0, Purpose::kInstance});
    KeyGrant grant;
    grant.count = 3;
    for (std::size_t k = 0; k < grant.count; ++k) grant.keys[k].port = Port::kSlaveNeedle;
    int accepted = 0;
    for (int i = 0; i < 20000; ++i) {
        KeyText text{};
        const Bytes good = write_grant(grant, text);
        std::vector<std::uint8_t> bytes(good.begin(), good.end());
        if (i % 2 == 0) {
            write_seal_header({PacketKind::kData, Port::kSlaveNeedle, 0, 1},
                              std::span(bytes).first<kSealHeaderBytes>());
        }
        bytes[random.below(static_cast<std::uint32_t>(bytes.size()))] ^= static_cast<std::uint8_t>(random());
        const Verdict verdict = check_sealed_bytes(bytes);
        ASSERT_EQ(verdict.flaw, "") << i;
        if (verdict.accepted) ++accepted;
    }
    EXPECT_GT(accepted, 1000);
}

TEST(HostileSecurity, RandomScriptsAtTheStopLine) {
    RandomStream random({5, 0, 0, 0, Purpose::kInstance});
    int stopped = 0;
    for (int i = 0; i < 300; ++i) {
        std::vector<std::uint8_t> script(random.below(100));
        for (std::uint8_t& byte : script) byte = static_cast<std::uint8_t>(random());
        const Verdict verdict = check_stop_script(script);
        EXPECT_EQ(verdict.flaw, "") << i;
        EXPECT_EQ(check_stop_bytes(script).flaw, "") << i;
        if (verdict.accepted) ++stopped;
    }
    EXPECT_GT(stopped, 50);  // the scripts get somewhere
}

}  // namespace
}  // namespace thimble
