// Ranges as typed, and those that come with the program.
#include "study/sweeps/parameter_range.hpp"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/refusal.hpp"

namespace thimble {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(ParameterRange, ReadsWhatIsTyped) {
    const ParameterRange range = parse_parameter_range("operator.brake_s=0.08:0.25:5");
    EXPECT_EQ(range.name(), "operator.brake_s");
    EXPECT_EQ(range.points, 5U);
    EXPECT_EQ(range.at(0), 0.08);
    EXPECT_DOUBLE_EQ(range.at(4), 0.25);
    EXPECT_DOUBLE_EQ(range.at(2), 0.165);
    EXPECT_EQ(parse_parameter_range("handle.friction_N=-1e-3:2").points, 0U);
    EXPECT_EQ(parse_parameter_range("operator.brake_s=80ms:0.25s").low, 0.08);
    EXPECT_EQ(parse_parameter_range("handle.friction_N=-1e-3:2").low, -1e-3);
}

TEST(ParameterRange, RefusesTheRestAndSaysHowToWriteIt) {
    for (const char* text :
         {"", "brake_s=0:1:3", "operator.brake_s", "operator.brake_s=", "operator.brake_s=1",
          "operator.brake_s=1:1:3", "operator.brake_s=2:1:3", "operator.brake_s=0:1:1",
          "operator.brake_s=0:1:x", "operator.brake_s=0:1:3:4", "operator.brake_s=a:1:3",
          "operator.brake_s=0:nan:3", "operator.brake_s=0:inf:3", "operator.brake_s=0:1:-2",
          "operator.brake_s=0:1:1001", "operator.brake_s=0:1 :3", "operator.brake_s=0:1xs",
          "handle.friction_N=0:1s", "netem.force.delay_s=0:0.1:3"}) {
        EXPECT_THAT(refusal([&] { parse_parameter_range(text); }, ExitCode::kUsage),
                    AllOf(HasSubstr("--vary"), HasSubstr("LOW:HIGH"), HasSubstr(text)))
            << text;
    }
}

// A key that is spelt wrong, or an end that the file would refuse, fails here.
TEST(ParameterRange, DocumentedOnesAreKeysOfASessionFileAtBothEnds) {
    std::set<std::string> names;
    for (const ParameterRange& range : documented_ranges()) {
        EXPECT_LT(range.low, range.high) << range.name();
        EXPECT_TRUE(names.insert(range.name()).second) << range.name();
        for (const double share : {0.0, 1.0}) {
            std::vector<SettingChange> changes;
            range.set(changes, range.within(share));
            EXPECT_NO_THROW(load_system_settings("", changes)) << range.name() << ' ' << share;
        }
    }
    EXPECT_GE(names.size(), 28U);
}

// Two keys that say the same thing of one device are varied together, also if only one is typed.
TEST(ParameterRange, ADocumentedNameBringsAllItsKeys) {
    const ParameterRange range = parse_parameter_range("cutaneous.force_limit_N=1.5:5:4");
    ASSERT_EQ(range.keys.size(), 2U);
    std::vector<SettingChange> changes;
    range.set(changes, range.at(3));
    const SystemSettings settings = load_system_settings("", changes);
    EXPECT_EQ(settings.cutaneous.force_limit_N, 5);
    EXPECT_EQ(settings.person.perception.full_scale_cutaneous_N, 5);
}

TEST(SettingChange, StandsAsIfItWereInTheFile) {
    const SystemSettings settings = load_system_settings("", {{"handle.friction_N", 0.25}});
    EXPECT_EQ(settings.handle.mechanics.friction_N, 0.25);
    EXPECT_EQ(settings.person.perception.criterion_N, SystemSettings{}.person.perception.criterion_N);
    EXPECT_THROW(load_system_settings("", {{"handle.fricion_N", 0.25}}), Error);
    EXPECT_THROW(load_system_settings("", {{"handle.friction_N", -1}}), Error);
    EXPECT_THROW(load_system_settings("", {{"handle.", 1}}), Error);
}

}  // namespace
}  // namespace thimble
