// Advice names a key that the user may have meant, and no other word.
#include "common/nearest_name.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace thimble {
namespace {

TEST(NearestName, NoNameIsNearAVeryLongOne) {
    EXPECT_EQ(nearest_name(std::string(1'000'000, 'x'), {"x", std::string(1'000'000, 'x')}), "");
}

TEST(NearestName, FindsSwappedLettersAndAnotherCaseButNoOtherWord) {
    EXPECT_EQ(nearest_name("dealy_s", {"delay_s", "loss"}), "delay_s");
    EXPECT_EQ(nearest_name("hf", {"CF", "HF"}), "HF");
    EXPECT_EQ(nearest_name("speed", {"delay_s", "loss"}), "");
    EXPECT_EQ(nearest_name("", {"a"}), "a");
    EXPECT_EQ(nearest_name("x", {}), "");
    EXPECT_EQ(nearest_name("--delay-ms", {"--seed", "--delay-s"}), "--delay-s");
    EXPECT_EQ(nearest_name("position", {"force_position_scale", "position_scale"}), "position_scale");
    EXPECT_EQ(nearest_name("stiffness", {"stiff", "stiffness_N_per_m"}), "stiffness_N_per_m");
}

}  // namespace
}  // namespace thimble
