// The guard alone: whatever is asked of it, and whatever the handle says.
#include "master/force_guard.hpp"

#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "common/error.hpp"
#include "master/master_node.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

constexpr Duration kSample = milliseconds{1};
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

GuardSettings guard_settings(const std::string& text) {
    const ConfigFile file = ConfigFile::parse("[guard]\n" + text, "guard.toml");
    const GuardSettings settings = read_guard_settings(file.table("guard"));
    file.finish();
    return settings;
}

// Any bits: numbers of all sizes, zeros of both signs, infinities, NaNs.
double any_double() {
    const auto bits = *rc::gen::arbitrary<std::uint64_t>();
    double value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return *rc::gen::element(value, 1e-3 * *rc::gen::inRange(-20000, 20000), kNan, kInfinity, -kInfinity,
                             0.0);
}

GuardSettings any_settings() {
    GuardSettings s;
    s.force_limit_N = *rc::gen::inRange(0, 20);
    s.force_rate_limit_N_per_s = *rc::gen::element(0.0, 1.0, 500.0, 1e5);
    s.energy_limit_J = *rc::gen::element(0.0, 0.001, 1.0);
    s.energy_window = milliseconds(*rc::gen::inRange(10, 2000));
    return s;
}

TEST(ForceGuard, NeverGivesMoreThanItMayWhateverComes) {
    EXPECT_TRUE(rc::check([] {
        const GuardSettings settings = any_settings();
        ForceGuard guard(settings, kSample);
        SessionTime now{};
        guard.clear(now);
        double before_N = 0;
        bool tripped = false;
        for (int i = 0; i < 60; ++i) {
            const Duration step = std::chrono::microseconds(*rc::gen::inRange(-100, 50'000));
            now += step;
            if (*rc::gen::arbitrary<bool>())
                guard.observe(now, {any_double(), any_double(), *rc::gen::arbitrary<bool>()});
            const double wanted_N = any_double();
            const double given_N = guard.pass(now, wanted_N);
            RC_ASSERT(std::isfinite(given_N));
            RC_ASSERT(std::abs(given_N) <= settings.force_limit_N);
            RC_ASSERT(!(std::abs(given_N) > std::abs(wanted_N)));
            RC_ASSERT(given_N * (std::isfinite(wanted_N) ? wanted_N : 0) >= 0);
            RC_ASSERT(!(tripped && given_N != 0));
            const double rate = settings.force_rate_limit_N_per_s;
            const double counted_s = to_seconds(std::clamp(step, Duration{}, Duration{kSample}));
            const double most_N = std::abs(before_N) + rate * counted_s;
            if (rate > 0 && step > Duration{}) RC_ASSERT(std::abs(given_N) <= most_N * (1 + 1e-12) + 1e-12);
            tripped = guard.tripped();
            RC_ASSERT(tripped == !guard.words().empty());
            before_N = given_N;
        }
    }));
}

TEST(ForceGuard, ChangesNoBitOfWhatIsAllowed) {
    EXPECT_TRUE(rc::check([] {
        ForceGuard guard{GuardSettings{}, kSample};
        guard.clear({});
        for (int i = 0; i < 50; ++i) {
            const double wanted_N = 12e-6 * *rc::gen::inRange(-1'000'000, 1'000'001);
            const double given_N = guard.pass(SessionTime{milliseconds{i}}, wanted_N);
            RC_ASSERT(std::memcmp(&wanted_N, &given_N, sizeof wanted_N) == 0);
        }
        RC_ASSERT(guard.cut() == 0U);
    }));
}

TEST(ForceGuard, WhatIsNoNumberTripsUntilCleared) {
    for (const double wanted_N : {kNan, kInfinity, -kInfinity}) {
        ForceGuard guard{GuardSettings{}, kSample};
        guard.clear({});
        EXPECT_EQ(guard.pass({}, 3), 3);
        EXPECT_EQ(guard.pass({}, wanted_N), 0);
        EXPECT_TRUE(guard.tripped());
        EXPECT_EQ(guard.pass({}, 3), 0) << "latched";
        guard.clear({});
        EXPECT_EQ(guard.pass({}, 3), 3);
    }
    ForceGuard guard{GuardSettings{}, kSample};
    guard.clear({});
    guard.observe({}, {kNan, 0, false});
    EXPECT_FALSE(guard.tripped()) << "a failed device says so itself";
    guard.observe({}, {kNan, 0});
    EXPECT_TRUE(guard.tripped());
}

TEST(ForceGuard, AForceGrowsNoFasterThanAllowedAndFallsAtOnce) {
    ForceGuard guard(guard_settings("force_rate_limit_N_per_s = 1000"), kSample);
    guard.clear({});
    for (int ms = 1; ms <= 8; ++ms) EXPECT_DOUBLE_EQ(guard.pass(SessionTime{milliseconds{ms}}, 8), ms);
    EXPECT_EQ(guard.pass(SessionTime{milliseconds{8}}, 0.5), 0.5);
    EXPECT_DOUBLE_EQ(guard.pass(SessionTime{milliseconds{9}}, -8), -1)
        << "through zero, not from the other side";
    EXPECT_GT(guard.cut(), 0U);
}

// The rate limit counts one sample at most after a silence or at a new trial.
TEST(ForceGuard, AForceGrowsByOneSampleAtMostHoweverLongTheGuardWasSilent) {
    ForceGuard guard(guard_settings("force_rate_limit_N_per_s = 100"), kSample);
    guard.clear({});
    EXPECT_DOUBLE_EQ(guard.pass(SessionTime{milliseconds{120}}, 12), 0.1) << "a trial's first force";
    EXPECT_DOUBLE_EQ(guard.pass(SessionTime{milliseconds{121}}, 12), 0.2);
    EXPECT_DOUBLE_EQ(guard.pass(SessionTime{milliseconds{211}}, 12), 0.3) << "after 90 ms of silence";
    EXPECT_DOUBLE_EQ(guard.pass(SessionTime{milliseconds{301}}, -12), -0.1) << "in the other direction";
    guard.clear(SessionTime{milliseconds{302}});
    EXPECT_DOUBLE_EQ(guard.pass(SessionTime{milliseconds{500}}, 12), 0.1) << "of the next trial";
    ForceGuard slow(guard_settings("force_rate_limit_N_per_s = 100"), milliseconds{5});
    slow.clear({});
    EXPECT_DOUBLE_EQ(slow.pass(SessionTime{milliseconds{4}}, 12), 0.4) << "time that has not passed";
    EXPECT_DOUBLE_EQ(slow.pass(SessionTime{milliseconds{95}}, 12), 0.9);
}

// A spring that pushes out harder than it was pressed in: 2 N in over 10 mm, 6 N out, again and again.
void pump(ForceGuard& guard, int cycles, double out_N, Duration step) {
    SessionTime now{};
    for (int i = 0; i < cycles && !guard.tripped(); ++i) {
        for (int k = 0; k <= 10; ++k) guard.observe(now += step, {k * 1e-3, 2});
        for (int k = 10; k >= 0; --k) guard.observe(now += step, {k * 1e-3, out_N});
    }
}

TEST(ForceGuard, EnergyGivenOutTrips) {
    ForceGuard guard(guard_settings("energy_limit_J = 0.1\nenergy_window_s = 1"), kSample);
    guard.clear({});
    pump(guard, 1, 6, milliseconds{1});  // 20 mJ in, 60 mJ out
    EXPECT_FALSE(guard.tripped());
    EXPECT_NEAR(guard.most_given_out_J(), 0.06, 1e-9);
    pump(guard, 3, 6, milliseconds{1});  // 60 mJ in, 180 mJ out
    EXPECT_TRUE(guard.tripped());
    EXPECT_NE(guard.words().find("energy_limit_J"), std::string::npos) << guard.words();
    EXPECT_EQ(guard.pass({}, 1), 0);

    ForceGuard passive(guard_settings("energy_limit_J = 0.1"), kSample);
    passive.clear({});
    pump(passive, 1000, 2, milliseconds{1});
    EXPECT_FALSE(passive.tripped()) << "a spring gives back what it got: 20 mJ";
}

// A report is read for the cause, not for what followed from it.
TEST(ForceGuard, TheFirstReasonOfATripStaysUntilTheNextTrial) {
    ForceGuard guard(guard_settings("energy_limit_J = 0.1"), kSample);
    guard.clear({});
    pump(guard, 10, 6, milliseconds{1});
    ASSERT_TRUE(guard.tripped());
    const std::string first(guard.words());
    EXPECT_NE(first.find("energy_limit_J"), std::string::npos) << first;
    guard.pass({}, kNan);
    guard.observe({}, {kNan, kNan});
    EXPECT_EQ(guard.words(), first);
    guard.clear({});
    guard.observe({}, {kNan, 0});
    EXPECT_EQ(guard.words(), "the handle's own measurement is no number");
    guard.pass({}, kNan);
    EXPECT_EQ(guard.words(), "the handle's own measurement is no number");
}

TEST(ForceGuard, WhatWasGivenOutLongAgoDoesNotCount) {
    ForceGuard guard(guard_settings("energy_limit_J = 0.1\nenergy_window_s = 0.5"), kSample);
    guard.clear({});
    pump(guard, 100, 3, milliseconds{20});  // 10 mJ net in each 0.44 s
    EXPECT_FALSE(guard.tripped());
    ForceGuard longer(guard_settings("energy_limit_J = 0.1\nenergy_window_s = 20"), kSample);
    longer.clear({});
    pump(longer, 100, 3, milliseconds{20});
    EXPECT_TRUE(longer.tripped());
}

TEST(GuardSettings, ReadsAndRefuses) {
    const GuardSettings s = guard_settings(
        "force_limit_N = 3\nforce_rate_limit_N_per_s = 900\nenergy_limit_J = 0.2\nenergy_window_s = 2");
    EXPECT_EQ(s.force_limit_N, 3);
    EXPECT_EQ(s.force_rate_limit_N_per_s, 900);
    EXPECT_EQ(s.energy_limit_J, 0.2);
    EXPECT_EQ(s.energy_window, Duration{std::chrono::seconds{2}});
    EXPECT_EQ(guard_settings("").force_limit_N, 12);
    for (const char* text : {"force_limit_N = -1", "energy_limit_J = -1", "energy_window_s = 0.5",
                             "limit_N = 3", "energy_limit_J = 1\nenergy_window_s = 0"}) {
        EXPECT_THROW(guard_settings(text), Error) << text;
    }
}

TEST(GuardSettings, TheMasterMayNotAskForMoreThanTheGuardLetsThrough) {
    const auto limit_N = [](const std::string& text) {
        const ConfigFile file = ConfigFile::parse(text, "master.toml");
        return read_master_settings(file).force_limit_N;
    };
    EXPECT_EQ(limit_N(""), 12);
    EXPECT_EQ(limit_N("[guard]\nforce_limit_N = 3"), 12) << "its own default is cut, not refused";
    EXPECT_EQ(limit_N("[master]\nforce_limit_N = 20\n[guard]\nforce_limit_N = 20"), 20);
    try {
        limit_N("[master]\nforce_limit_N = 20");
        ADD_FAILURE() << "accepted";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("[guard] force_limit_N"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace thimble
