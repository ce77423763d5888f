// Needle paths as people make them: what is read, and how each mistake is named.
#include "session/records/needle_file.hpp"

#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/refusal.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

NeedlePath parse(const std::string& text) { return parse_needle_path(text, "needle.csv", NeedleLimits{}); }

std::string refusal_of(const std::string& text) {
    return refusal([&] { parse(text); });
}

const std::string kHeader = "time_s,position_needle_m\n";

TEST(NeedleFile, ReadsSamplesToTheLastBit) {
    const NeedlePath path = parse(kHeader + "-1,0\n0.1,0.020000000000000004\n0.30000000000000004,1e-3\n");
    ASSERT_EQ(path.samples.size(), 3u);
    EXPECT_EQ(path.samples[0].time_s, -1);
    EXPECT_EQ(path.samples[1].position_m, 0.020000000000000004);
    EXPECT_EQ(path.samples[2].time_s, 0.1 + 0.2);
    EXPECT_EQ(path.samples[2].line, 4u);
}

TEST(NeedleFile, FindsItsColumnsAmongOthers) {
    const NeedlePath path =
        parse("position_needle_m,tissue_phase,time_s\n0.01,free,0\n0.02,penetrated,1\n# ended: completed\n");
    ASSERT_EQ(path.samples.size(), 2u);
    EXPECT_EQ(path.samples[1].time_s, 1);
    EXPECT_EQ(path.samples[1].position_m, 0.02);
}

TEST(NeedleFile, TakesWhatSpreadsheetsWrite) {
    const NeedlePath path =
        parse("\xEF\xBB\xBFtime_s, position_needle_m\r\n0, +0.5\r\n 1 ,\t-0.5\r\n2,0\r\n\r\n\n");
    ASSERT_EQ(path.samples.size(), 3u);
    EXPECT_EQ(path.samples[0].position_m, 0.5);
    EXPECT_EQ(path.samples[1].position_m, -0.5);
    EXPECT_EQ(parse(kHeader + "0,0\n1,0.25").samples.back().position_m, 0.25);  // no newline at the end
}

TEST(NeedleFile, TakesSemicolonsAndDecimalCommas) {
    const NeedlePath path = parse("\xEF\xBB\xBFtime_s;position_needle_m\r\n0;0,5\r\n0,5;-0,25\r\n");
    ASSERT_EQ(path.samples.size(), 2u);
    EXPECT_EQ(path.samples[1].time_s, 0.5);
    EXPECT_EQ(path.samples[1].position_m, -0.25);
    EXPECT_EQ(path.samples[1].line, 3u);
    EXPECT_THAT(refusal_of("time_s;position_needle_m\n0;1.234,5\n"),
                AllOf(StartsWith("needle.csv:2:"), HasSubstr("not as a decimal comma")));
}

TEST(NeedleFile, AFastHandIsStillAHand) {
    EXPECT_EQ(parse(kHeader + "0,0\n0.001,0.00999\n").samples.size(), 2u);
}

TEST(NeedleFile, NamesLineAndMistake) {
    struct Case {
        std::string lines;
        const char *place, *why;
    };
    for (const Case& c : {
             Case{"0,0\n0,0\n", "needle.csv:3:", "times must increase"},
             Case{"0,0\n1,0\n0.5,0\n", "needle.csv:4:", "times must increase"},
             Case{"0,0\n1,\n", "needle.csv:3:", "position_needle_m is empty"},
             Case{"0,0\n,0\n", "needle.csv:3:", "time_s is empty"},
             Case{"0,0\n\n1,0\n", "needle.csv:3:", "empty line"},
             Case{"0,0\n1\n", "needle.csv:3:", "has 1 fields, the header 2"},
             Case{"0,0,0\n", "needle.csv:2:", "has 3 fields"},
             Case{"0,zero\n", "needle.csv:2:", "'zero'"},
             Case{"0,0.1x\n", "needle.csv:2:", "'0.1x'"},
             Case{"0,nan\n", "needle.csv:2:", "not a finite number"},
             Case{"0,-inf\n", "needle.csv:2:", "not a finite number"},
             Case{"0,1e999\n", "needle.csv:2:", "not a finite number"},
             Case{"0,+\n", "needle.csv:2:", "not a finite number"},
             Case{"0,+-1\n", "needle.csv:2:", "'+-1', which is not a finite number"},
             Case{"0,0\n11,0\n", "needle.csv:3:", "a gap of 11 s since line 2"},
             Case{"0,12\n", "needle.csv:2:", "are these millimetres?"},
             Case{"0,0\n5e-324,1\n", "needle.csv:3:", "would have moved"},
             Case{"0,0\n0.001,0.0101\n", "needle.csv:3:", "since line 2, at 10.1 m/s"},
             Case{"0,3\n0.001,2.985\n", "needle.csv:3:", "millimetres"},
             Case{"", "needle.csv:1:", "no sample"},
         }) {
        EXPECT_THAT(refusal_of(kHeader + c.lines), AllOf(StartsWith(c.place), HasSubstr(c.why))) << c.lines;
    }
}

TEST(NeedleFile, NamesAHeaderThatIsNone) {
    for (const auto& [text, why] :
         {std::pair{"", "must begin with the header time_s,position_needle_m"},
          std::pair{"0,0\n1,1\n", "no column time_s"},
          std::pair{"time_s,position_m\n0,0\n", "no column position_needle_m"},
          std::pair{"time_s,position_needle_m,position_needle_m\n0,0,1\n", "names position_needle_m twice"},
          std::pair{"time_s,time_s,position_needle_m\n0,1,1\n", "names time_s twice"}})
        EXPECT_THAT(refusal_of(text), AllOf(StartsWith("needle.csv:1:"), HasSubstr(why)));
}

TEST(NeedleFile, ACommaThatEndsTheHeaderIsAColumn) {
    EXPECT_EQ(parse("time_s,position_needle_m,\n0,0.25,\n").samples.back().position_m, 0.25);
    EXPECT_THAT(refusal_of("time_s,position_needle_m,\n0,0.25\n"), HasSubstr("has 2 fields, the header 3"));
}

TEST(NeedleFile, AGapIsWhatTheCallerSays) {
    NeedleLimits limits;
    limits.longest_gap_s = 100;
    EXPECT_EQ(parse_needle_path(kHeader + "0,0\n60,0\n", "x", limits).samples.size(), 2u);
}

TEST(NeedleFile, AFileThatIsNotThere) {
    EXPECT_THROW(read_needle_path("/nowhere/needle.csv", NeedleLimits{}), Error);
    EXPECT_THROW(read_needle_path("/", NeedleLimits{}), Error);
}

}  // namespace
}  // namespace thimble
