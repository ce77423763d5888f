// The seeded little sister of fuzz_hid: a gamepad's descriptor and its reports, damaged.
#include <gtest/gtest.h>

#include "common/random.hpp"
#include "tests/fuzz/hid_check.hpp"
#include "tests/unit/hid/fake_hid.hpp"

namespace thimble::test {
namespace {

TEST(HostileHid, NothingThatADeviceSaysDoesHarm) {
    RandomStream random(StreamKey{.study = 1});
    Report whole{static_cast<std::uint8_t>(kGamepadDescriptor.size())};
    whole.insert(whole.end(), kGamepadDescriptor.begin(), kGamepadDescriptor.end());
    for (int i = 0; i < 40; ++i) whole.push_back(static_cast<std::uint8_t>(random()));
    EXPECT_TRUE(check_hid_bytes(whole).accepted);
    int accepted = 0;
    for (int i = 0; i < 20'000; ++i) {
        Report damaged = whole;
        for (std::uint32_t n = 1 + random.below(3); n > 0; --n)
            damaged[random.below(static_cast<std::uint32_t>(damaged.size()))] =
                static_cast<std::uint8_t>(random());
        const Verdict verdict = check_hid_bytes(damaged);
        ASSERT_EQ(verdict.flaw, "") << i;
        accepted += verdict.accepted ? 1 : 0;
    }
    EXPECT_GT(accepted, 1000);
    EXPECT_LT(accepted, 19'000);
}

}  // namespace
}  // namespace thimble::test
