// Durations with a unit, in files and on the command line.
#include "common/duration_text.hpp"

#include <map>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "common/time.hpp"

namespace thimble {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(DurationText, AUnitMovesTheDecimalPointAndNoBit) {
    const std::map<std::string, double> cases{{"50ms", 0.05},   {"50 ms", 0.05},      {"0.05s", 0.05},
                                              {"100us", 1e-4},  {"100\u00b5s", 1e-4}, {"1.5e2ms", 0.15},
                                              {"300ns", 3e-7},  {"2min", 120},        {"1h", 3600},
                                              {"-9ms", -0.009}, {"0e99999s", 0}};
    for (const auto& [text, time_s] : cases) EXPECT_EQ(parse_duration(text), time_s) << text;
}

TEST(DurationText, AnythingElseIsNone) {
    for (const char* text : {"", "50", "ms", "50xs", "50  ms", "50ms ", "50 MS", "inf s", "nans", "0x1s",
                             "1e999s", "1e308h", "1,5s"})
        EXPECT_FALSE(parse_duration(text)) << text;
}

// A printed duration comes back, and as the same double as the bare number.
RC_GTEST_PROP(DurationText, RoundTrip, ()) {
    const auto ns = *rc::gen::inRange<std::int64_t>(-1'000'000'000'000'000, 1'000'000'000'000'000);
    RC_ASSERT(from_seconds(*parse_duration(fmt::format("{}ns", ns))) == Duration{ns});
    const std::string ms =
        fmt::format("{}{}.{:06}", ns < 0 ? "-" : "", std::abs(ns) / 1'000'000, std::abs(ns) % 1'000'000);
    RC_ASSERT(*parse_duration(ms + "ms") == std::stod(ms + "e-3"));
    const double as_double = to_seconds(Duration{ns});
    const auto read = parse_duration(fmt::format("{}s", as_double));
    RC_ASSERT(read == as_double);
}

TEST(DurationText, NamesSayWhatHoldsSeconds) {
    for (const char* name : {"delay_s", "delays_s", "--delay-s", "--seconds"})
        EXPECT_TRUE(holds_seconds(name)) << name;
    for (const char* name : {"speed_m_per_s", "--frames-per-s", "stiffness_Ns", "seed"})
        EXPECT_FALSE(holds_seconds(name)) << name;
}

TEST(DurationText, MillisecondsWrittenAsSecondsAreDoubtedForNetworksOnly) {
    for (const char* name :
         {"delay_s", "delays_s", "jitter_spread_s", "slot_most_s", "--force-delay-s", "--jitter-s"})
        EXPECT_EQ(doubt_seconds(name, 50),
                  "50, but no network takes 50 s: for 50 ms write 0.05 or \"50ms\"; for 50 s write \"50s\"")
            << name;
    EXPECT_EQ(doubt_seconds("delay_s", 1.3), "") << "to the moon";
    for (const char* name : {"contact_hold_s", "--seconds", "slot_packets", "fixture_jitter_m"})
        EXPECT_EQ(doubt_seconds(name, 50), "") << name;
    EXPECT_EQ(meant_milliseconds("dead_time_s", 20, 0, 1), "; for 20 ms write 0.02 or \"20ms\"");
    EXPECT_EQ(meant_milliseconds("dead_time_s", 2000, 0, 1), "");
    EXPECT_EQ(meant_milliseconds("force_limit_N", 20, 0, 1), "");
}

TEST(DurationText, WordsOfOptions) {
    const auto settled = [](std::string word) {
        const std::string wrong = settle_durations("--delay-s", word);
        return wrong.empty() ? word : wrong;
    };
    EXPECT_EQ(settled("50ms"), "0.05");
    EXPECT_EQ(settled("0.05"), "0.05");
    EXPECT_EQ(settled("0,9ms,50ms"), "0,0.009,0.05");
    EXPECT_EQ(settled("0:200ms:41"), "0:0.2:41");
    EXPECT_EQ(settled("5s"), "5");
    EXPECT_EQ(settled("0,0.1,"), "0,0.1,") << "the option's own to refuse";
    EXPECT_EQ(settled("x"), "x");
    EXPECT_THAT(settled("50xs"), AllOf(HasSubstr("'50xs'"), HasSubstr("ns, us, ms, s, min, h")));
    EXPECT_THAT(settled("0,50"), HasSubstr("for 50 ms write 0.05"));
}

}  // namespace
}  // namespace thimble
