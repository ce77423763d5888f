#include "common/stale_policy.hpp"

#include <string>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/force_age.hpp"
#include "common/stale_record.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

StalePolicy stale_policy(const std::string& text) {
    const ConfigFile file = ConfigFile::parse("[master]\n" + text, "stale.toml");
    const StalePolicy policy =
        read_stale_policy(file.table("master"), StalePolicy{StaleMode::kRamp}, milliseconds{1}, seconds{1});
    file.finish();
    return policy;
}

TEST(StalePolicy, EachModeInTime) {
    const StalePolicy hold{StaleMode::kHold}, ramp{StaleMode::kRamp}, zero{StaleMode::kZero};
    for (const StalePolicy& policy : {hold, ramp, zero}) {
        EXPECT_EQ(policy.share(milliseconds{-5}), 1);
        EXPECT_EQ(policy.share(milliseconds{99}), 1);
    }
    EXPECT_EQ(hold.share(seconds{3}), 1);
    EXPECT_EQ(zero.share(milliseconds{100}), 0);
    EXPECT_EQ(ramp.share(milliseconds{100}), 1);
    EXPECT_DOUBLE_EQ(ramp.share(milliseconds{105}), 0.75);
    EXPECT_DOUBLE_EQ(ramp.share(milliseconds{110}), 0.5);
    EXPECT_EQ(ramp.share(milliseconds{120}), 0);
    EXPECT_EQ(ramp.share(seconds{9}), 0);
    const StalePolicy at_once{StaleMode::kRamp, milliseconds{10}, milliseconds{0}};
    EXPECT_EQ(at_once.share(milliseconds{10}), 0) << "a ramp of no length";
}

TEST(StalePolicy, IsReadAndSaidInWords) {
    EXPECT_EQ(stale_policy("").text(), "ramp to zero within 20 ms after 100 ms");
    EXPECT_EQ(stale_policy("stale = 'hold'\nstale_after_s = 0.05").text(), "hold after 50 ms");
    EXPECT_EQ(stale_policy("stale = 'zero'").text(), "zero after 100 ms");
    EXPECT_EQ(stale_policy("stale_ramp_s = 0.2").text(), "ramp to zero within 200 ms after 100 ms");
}

TEST(StalePolicy, RefusesWhatMakesNoSense) {
    for (const char* text :
         {"stale = 'stop'", "stale = 1", "stale_after_s = 0", "stale_ramp_s = -1",
          "stale = 'zero'\nstale_ramp_s = 0.1", "stale = 'hold'\nstale_ramp_s = 0.1", "stale_s = 1"}) {
        EXPECT_THROW(stale_policy(text), Error) << text;
    }
}

TEST(StaleRecord, SaysInWhichTrialHowOftenAndHowLong) {
    const auto ms = [](int time) { return SessionTime{milliseconds{time}}; };
    StaleRecord record;
    record.watch(ms(0), 1, true);  // has not come yet in this trial
    EXPECT_EQ(record.trials(), 0U);
    record.watch(ms(1), 1, false);
    record.watch(ms(10), 1, true);
    record.watch(ms(11), 1, true);
    record.watch(ms(15), 1, false);
    record.watch(ms(20), 1, true);
    record.end(ms(40));
    record.watch(ms(50), 2, false);
    record.watch(ms(60), 3, false);
    record.watch(ms(61), 3, true);
    record.watch(ms(62), 3, false);
    ASSERT_EQ(record.trials(), 2U);
    EXPECT_EQ(record.known()[0].trial, 1U);
    EXPECT_EQ(record.known()[0].times, 2U);
    EXPECT_EQ(record.known()[0].acted, Duration(milliseconds{25}));
    EXPECT_EQ(record.known()[0].longest, Duration(milliseconds{20}));
    EXPECT_EQ(record.known()[1].trial, 3U);
}

TEST(StaleRecord, KeepsTheNewestTrials) {
    StaleRecord record;
    for (std::uint32_t trial = 1; trial <= 100; ++trial) {
        record.watch(SessionTime{seconds{trial}}, trial, false);
        record.watch(SessionTime{seconds{trial} + milliseconds{1}}, trial, true);
        record.end(SessionTime{seconds{trial} + milliseconds{2}});
    }
    EXPECT_EQ(record.trials(), 100U);
    ASSERT_EQ(record.known().size(), 64U);
    for (const StaleRecord::Trial& one : record.known()) {
        EXPECT_GT(one.trial, 36U);
        EXPECT_EQ(one.acted, Duration(milliseconds{1}));
    }
}

TEST(ForceAge, KnowsWhatIsOlderThanTheNetworkMakesIt) {
    const auto at = [](int ms) { return SessionTime{milliseconds{ms}}; };
    ForceAge own;
    own.begin(at(0), milliseconds{50});
    EXPECT_LT(own.late(at(49)), Duration::zero()) << "nothing can have come";
    own.take(at(100));
    EXPECT_EQ(own.late(at(150)), Duration::zero());
    EXPECT_EQ(own.late(at(180)), Duration(milliseconds{30}));
    own.allow(milliseconds{80});
    EXPECT_EQ(own.late(at(180)), Duration::zero());
    own.allow(milliseconds{10});
    EXPECT_EQ(own.late(at(180)), Duration::zero()) << "old ones are still under way";
    // On a clock that is an hour ahead: only how the delay grows can be seen.
    ForceAge elsewhere;
    elsewhere.begin(at(0), milliseconds{20});
    const auto said_at = [&](int ms) { return at(3600'000 + ms); };
    elsewhere.take_from_elsewhere(at(100), said_at(95));
    EXPECT_EQ(elsewhere.late(at(100)), Duration(milliseconds{-20}));
    elsewhere.take_from_elsewhere(at(200), said_at(150));
    EXPECT_EQ(elsewhere.late(at(200)), Duration(std::chrono::microseconds{24'900}));
    elsewhere.take_from_elsewhere(at(210), said_at(209));  // the youngest so far
    EXPECT_EQ(elsewhere.late(at(210)), Duration(milliseconds{-20}));
    elsewhere.begin(at(300), milliseconds{20});
    elsewhere.take_from_elsewhere(at(400), said_at(350));
    EXPECT_EQ(elsewhere.late(at(400)), Duration(milliseconds{-20})) << "a new trial";
}

// The machine that makes the forces has a clock that is 500 ppm slow; after an hour its network becomes slower by 50 ms.
TEST(ForceAge, ClocksThatDriftApartAreNoDelayThatGrows) {
    using std::chrono::microseconds;
    const auto at = [](int ms) { return SessionTime{milliseconds{ms}}; };
    const auto said_at = [&](int ms) { return at(ms) - microseconds{ms / 2}; };
    ForceAge age;
    age.begin(at(0), milliseconds{20});
    for (int ms = 10; ms < 3600'000; ms += 10) {
        age.take_from_elsewhere(at(ms), said_at(ms - 3));
        ASSERT_LT(age.late(at(ms)), milliseconds{-19}) << ms;
    }
    for (int ms = 3600'000; ms < 3600'100; ms += 10) {
        age.take_from_elsewhere(at(ms), said_at(ms - 53));
        ASSERT_GT(age.late(at(ms)), milliseconds{29}) << ms;
    }
}

}  // namespace
}  // namespace thimble
