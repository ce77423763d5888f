// The guard before the handle: whatever is asked of it, and whatever the handle says. Then the guard within the master.
#include "master/guarded_handle.hpp"

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "master/master_process.hpp"
#include "tests/refusal.hpp"
#include "tests/unit/queue_ports.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

constexpr Duration kSample = milliseconds{1};
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Returns set measurements, and records its commands.
class NotingHandle final : public HapticDevice {
  public:
    HandleSample read(SessionTime) override { return sample; }
    void command_force(SessionTime, double force_hand_N) override {
        sample.force_hand_N = force_hand_N;
        largest_N = std::max(largest_N, force_hand_N);
    }
    void enable_force(SessionTime, bool) override {}
    bool take_stop(SessionTime) override { return false; }
    SessionTime next_look() const override { return kNever; }
    std::string_view fault() const override { return {}; }

    HandleSample sample;
    double largest_N = 0;  // since it was set
};

// The guard before such a handle.
struct Guarded {
    explicit Guarded(const GuardSettings& settings = {}, Duration sample_period = kSample)
        : guard(settings, sample_period, handle) {}
    explicit Guarded(const std::string& text, Duration sample_period = kSample)
        : Guarded(settings_of(text), sample_period) {}

    static GuardSettings settings_of(const std::string& text) {
        const ConfigFile file = ConfigFile::parse("[guard]\n" + text, "guard.toml");
        const GuardSettings settings = read_guard_settings(file.table("guard"));
        file.finish();
        return settings;
    }
    void observe(SessionTime now, const HandleSample& sample) {
        handle.sample = sample;
        guard.read(now);
    }
    double pass(SessionTime now, double wanted_N) {
        guard.command_force(now, wanted_N);
        return handle.sample.force_hand_N;
    }
    double pass(int ms, double wanted_N) { return pass(SessionTime{milliseconds{ms}}, wanted_N); }

    // A spring that pushes out harder than it was pressed in: 2 N in over 10 mm, `out_N` out, again and again.
    void pump(int cycles, double out_N, Duration step) {
        SessionTime now{};
        for (int i = 0; i < cycles && !guard.tripped(); ++i) {
            for (int k = 0; k <= 10; ++k) observe(now += step, {k * 1e-3, 2});
            for (int k = 10; k >= 0; --k) observe(now += step, {k * 1e-3, out_N});
        }
    }

    NotingHandle handle;
    GuardedHandle guard;
};

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

TEST(GuardedHandle, NeverGivesMoreThanItMayWhateverComes) {
    EXPECT_TRUE(rc::check([] {
        const GuardSettings settings = any_settings();
        Guarded guarded(settings);
        SessionTime now{};
        double before_N = 0;
        bool tripped = false;
        for (int i = 0; i < 60; ++i) {
            const Duration step = std::chrono::microseconds(*rc::gen::inRange(-100, 50'000));
            now += step;
            if (*rc::gen::arbitrary<bool>())
                guarded.observe(now, {any_double(), any_double(), *rc::gen::arbitrary<bool>()});
            const double wanted_N = any_double();
            const double given_N = guarded.pass(now, wanted_N);
            RC_ASSERT(std::isfinite(given_N));
            RC_ASSERT(std::abs(given_N) <= settings.force_limit_N);
            RC_ASSERT(!(std::abs(given_N) > std::abs(wanted_N)));
            RC_ASSERT(given_N * (std::isfinite(wanted_N) ? wanted_N : 0) >= 0);
            RC_ASSERT(!(tripped && given_N != 0));
            const double rate = settings.force_rate_limit_N_per_s;
            const double counted_s = to_seconds(std::clamp(step, Duration{}, Duration{kSample}));
            const double most_N = std::abs(before_N) + rate * counted_s;
            if (rate > 0 && step > Duration{}) RC_ASSERT(std::abs(given_N) <= most_N * (1 + 1e-12) + 1e-12);
            tripped = guarded.guard.tripped();
            RC_ASSERT(tripped == !guarded.guard.text().empty());
            before_N = given_N;
        }
    }));
}

TEST(GuardedHandle, ChangesNoBitOfWhatIsAllowed) {
    EXPECT_TRUE(rc::check([] {
        Guarded guarded;
        for (int i = 0; i < 50; ++i) {
            const double wanted_N = 12e-6 * *rc::gen::inRange(-1'000'000, 1'000'001);
            const double given_N = guarded.pass(i, wanted_N);
            RC_ASSERT(std::memcmp(&wanted_N, &given_N, sizeof wanted_N) == 0);
        }
        RC_ASSERT(guarded.guard.cut() == 0U);
    }));
}

TEST(GuardedHandle, WhatIsNoNumberTripsUntilCleared) {
    for (const double wanted_N : {kNan, kInfinity, -kInfinity}) {
        Guarded guarded;
        EXPECT_EQ(guarded.pass(0, 3), 3);
        EXPECT_EQ(guarded.pass(0, wanted_N), 0);
        EXPECT_TRUE(guarded.guard.tripped());
        EXPECT_EQ(guarded.pass(0, 3), 0) << "latched";
        guarded.guard.clear({});
        EXPECT_EQ(guarded.pass(0, 3), 3);
    }
    Guarded guarded;
    guarded.observe({}, {kNan, 0, false});
    EXPECT_FALSE(guarded.guard.tripped()) << "a failed device says so itself";
    guarded.observe({}, {kNan, 0});
    EXPECT_TRUE(guarded.guard.tripped());
}

TEST(GuardedHandle, AForceGrowsNoFasterThanAllowedAndFallsAtOnce) {
    Guarded guarded("force_rate_limit_N_per_s = 1000");
    for (int ms = 1; ms <= 8; ++ms) EXPECT_DOUBLE_EQ(guarded.pass(ms, 8), ms);
    EXPECT_EQ(guarded.pass(8, 0.5), 0.5);
    EXPECT_DOUBLE_EQ(guarded.pass(8, 9), 8) << "another force in the same instant";
    EXPECT_DOUBLE_EQ(guarded.pass(9, -8), -1) << "through zero, not from the other side";
    EXPECT_GT(guarded.guard.cut(), 0U);
}

// The rate limit counts one sample at most after a silence or at a new trial.
TEST(GuardedHandle, AForceGrowsByOneSampleAtMostHoweverLongTheGuardWasSilent) {
    Guarded guarded("force_rate_limit_N_per_s = 100");
    EXPECT_DOUBLE_EQ(guarded.pass(120, 12), 0.1) << "a trial's first force";
    EXPECT_DOUBLE_EQ(guarded.pass(121, 12), 0.2);
    EXPECT_DOUBLE_EQ(guarded.pass(211, 12), 0.3) << "after 90 ms of silence";
    EXPECT_DOUBLE_EQ(guarded.pass(301, -12), -0.1) << "in the other direction";
    guarded.guard.clear(SessionTime{milliseconds{302}});
    EXPECT_DOUBLE_EQ(guarded.pass(500, 12), 0.1) << "of the next trial";
    Guarded slow("force_rate_limit_N_per_s = 100", milliseconds{5});
    EXPECT_DOUBLE_EQ(slow.pass(4, 12), 0.4) << "time that has not passed";
    EXPECT_DOUBLE_EQ(slow.pass(95, 12), 0.9);
}

// A handle may withhold a force by itself, e.g. a Falcon that misses a report.
TEST(GuardedHandle, AForceGrowsFromWhatTheHandleGivesIfThatIsLess) {
    Guarded guarded("force_rate_limit_N_per_s = 1000");
    const auto pass_after = [&](int ms, const HandleSample& sample) {
        guarded.observe(SessionTime{milliseconds{ms}}, sample);
        return guarded.pass(ms, -8);
    };
    for (int ms = 1; ms <= 8; ++ms) guarded.pass(ms, -8);
    EXPECT_DOUBLE_EQ(pass_after(9, {0, -3}), -4);
    EXPECT_DOUBLE_EQ(pass_after(10, {0, -8}), -5) << "a handle that claims more changes nothing";
    EXPECT_DOUBLE_EQ(pass_after(11, {0, 0}), -1);
    EXPECT_DOUBLE_EQ(pass_after(12, {0, -1}), -2);
    EXPECT_DOUBLE_EQ(pass_after(13, {0, -2, false}), -1) << "one that has failed gives none";
    EXPECT_DOUBLE_EQ(pass_after(14, {0, -1}), -2);
    EXPECT_DOUBLE_EQ(pass_after(14, {0, -0.5}), -1.5) << "in the same instant as well";
}

TEST(GuardedHandle, EnergyGivenOutTrips) {
    Guarded guarded("energy_limit_J = 0.1\nenergy_window_s = 1");
    guarded.pump(1, 6, milliseconds{1});  // 20 mJ in, 60 mJ out
    EXPECT_FALSE(guarded.guard.tripped());
    EXPECT_NEAR(guarded.guard.most_given_out_J(), 0.06, 1e-9);
    guarded.pump(3, 6, milliseconds{1});  // 60 mJ in, 180 mJ out
    EXPECT_TRUE(guarded.guard.tripped());
    EXPECT_NE(guarded.guard.text().find("energy_limit_J"), std::string::npos) << guarded.guard.text();
    EXPECT_EQ(guarded.pass(0, 1), 0);

    Guarded passive("energy_limit_J = 0.1");
    passive.pump(1000, 2, milliseconds{1});
    EXPECT_FALSE(passive.guard.tripped()) << "a spring gives back what it got: 20 mJ";
    for (const auto& [window_s, trips] : {std::pair{"0.5", false}, {"20", true}}) {
        Guarded slow(std::string("energy_limit_J = 0.1\nenergy_window_s = ") + window_s);
        slow.pump(100, 3, milliseconds{20});  // 10 mJ net in each 0.44 s
        EXPECT_EQ(slow.guard.tripped(), trips) << "what was given out long ago does not count";
    }
}

// A report is read for the cause, not for what followed from it.
TEST(GuardedHandle, TheFirstReasonOfATripStaysUntilTheNextTrial) {
    Guarded guarded("energy_limit_J = 0.1");
    guarded.pump(10, 6, milliseconds{1});
    ASSERT_TRUE(guarded.guard.tripped());
    const std::string first(guarded.guard.text());
    EXPECT_NE(first.find("energy_limit_J"), std::string::npos) << first;
    guarded.pass(0, kNan);
    guarded.observe({}, {kNan, kNan});
    EXPECT_EQ(guarded.guard.text(), first);
    guarded.guard.clear({});
    for (const double wanted_N : {0.0, kNan}) {
        guarded.observe({}, {kNan, 0});
        guarded.pass(0, wanted_N);
        EXPECT_EQ(guarded.guard.text(), "the handle reports a value that is not a number");
    }
}

TEST(GuardedHandle, CountsTheWorkOfATrial) {
    Guarded guarded;
    const auto energy_J = [&](const HandleSample& sample) {
        guarded.observe({}, sample);
        return guarded.guard.energy().energy_in_J();
    };
    EXPECT_EQ(energy_J({0, 2}), 0) << "the first sample only says where the handle is";
    EXPECT_DOUBLE_EQ(energy_J({0.01, 2}), 0.02) << "pushed in against a force";
    EXPECT_DOUBLE_EQ(energy_J({0, 2}), 0) << "given back";
    EXPECT_DOUBLE_EQ(energy_J({0, 7}), 0) << "a force that moves nothing does no work";
    EXPECT_DOUBLE_EQ(energy_J({0.01, 7}), 0.07);
    guarded.guard.clear({});
    EXPECT_EQ(energy_J({0.5, 2}), 0);
}

TEST(GuardSettings, ReadsAndRefuses) {
    const GuardSettings s = Guarded::settings_of(
        "force_limit_N = 3\nforce_rate_limit_N_per_s = 900\nenergy_limit_J = 0.2\nenergy_window_s = 2");
    EXPECT_EQ(s.force_limit_N, 3);
    EXPECT_EQ(s.force_rate_limit_N_per_s, 900);
    EXPECT_EQ(s.energy_limit_J, 0.2);
    EXPECT_EQ(s.energy_window, Duration{std::chrono::seconds{2}});
    EXPECT_EQ(Guarded::settings_of("").force_limit_N, 12);
    for (const char* text : {"force_limit_N = -1", "energy_limit_J = -1", "energy_window_s = 0.5",
                             "limit_N = 3", "energy_limit_J = 1\nenergy_window_s = 0"}) {
        EXPECT_THROW(Guarded::settings_of(text), Error) << text;
    }
}

TEST(GuardSettings, AFileHasTheLastWordOnTheLimitsOfARealHandle) {
    const auto settings_of = [](const std::string& text) {
        const ConfigFile file = ConfigFile::parse(text, "real.toml");
        return read_master_settings(file, guard_of_real_handle()).guard;
    };
    EXPECT_EQ(settings_of("").force_rate_limit_N_per_s, 2250);
    EXPECT_EQ(settings_of("").energy_limit_J, 0.5);
    EXPECT_EQ(settings_of("").force_limit_N, 12);
    EXPECT_EQ(settings_of("[guard]\nenergy_limit_J = 0").energy_limit_J, 0);
    EXPECT_EQ(settings_of("[guard]\nforce_rate_limit_N_per_s = 0").force_rate_limit_N_per_s, 0);
    EXPECT_EQ(settings_of("[guard]\nenergy_window_s = 2").energy_window, Duration{std::chrono::seconds{2}});
}

TEST(GuardSettings, TheMasterMayNotAskForMoreThanTheGuardLetsThrough) {
    const auto limit_N = [](const std::string& text) {
        const ConfigFile file = ConfigFile::parse(text, "master.toml");
        return read_master_settings(file).force_limit_N;
    };
    EXPECT_EQ(limit_N(""), 12);
    EXPECT_EQ(limit_N("[guard]\nforce_limit_N = 3"), 12) << "its own default is cut, not refused";
    EXPECT_EQ(limit_N("[master]\nforce_limit_N = 20\n[guard]\nforce_limit_N = 20"), 20);
    const std::string why = refusal([&] { limit_N("[master]\nforce_limit_N = 20"); }, ExitCode::kUsage);
    EXPECT_NE(why.find("[guard] force_limit_N"), std::string::npos) << why;
}

class NobodyAtTheHandle final : public OperatorPort {
  public:
    void start_trial(SessionTime, const OperatorTask&) override {}
    void perceive(SessionTime, const Percept&) override {}
    bool finished() const override { return false; }
};

// The handle while the master is to keep its outputs at rest, and afterwards.
class RestingMaster : public testing::Test {
  protected:
    RestingMaster() {
        session.send(now, 1, SessionControl{.kind = ControlKind::kTrialStart, .modality = Modality::kHF});
        tick(milliseconds{0});
    }
    static MasterSettings settings() {
        MasterSettings s;
        s.guard.force_rate_limit_N_per_s = 1000;  // 1 N in a sample
        return s;
    }
    // A sample, and the answer to it.
    void tick(Duration later = milliseconds{1}) {
        now += later;
        slave.send(now, 1, ForceFeedback{.force_total_N = -5, .echo_time = now});
        process.tick(now);
    }
    double commanded_N() const { return handle.sample.force_hand_N; }

    QueuePorts ports;
    NotingHandle handle;
    NobodyAtTheHandle nobody;
    MasterProcess process{5, settings(), ports, handle, nobody};
    OutboundFlow session{Role::kSession, 1, {ports.far_end(Port::kMasterControl)}};
    OutboundFlow slave{Role::kSlaveSim, 2, {ports.far_end(Port::kMasterForce)}};
    SessionTime now{milliseconds{10}};
};

TEST_F(RestingMaster, NoForceReachesTheHandleAndAfterwardsItGrowsFromZero) {
    for (int ms = 0; ms < 8; ++ms) tick();
    ASSERT_EQ(commanded_N(), 5);
    process.set_overrun(OverrunPolicy::kRest, 3);
    process.deadlines_missed(now, 3);
    handle.largest_N = 0;
    for (int ms = 0; ms < 5; ++ms) {
        tick();
        EXPECT_EQ(commanded_N(), 0);
    }
    EXPECT_EQ(handle.largest_N, 0) << "not for an instant either";
    process.deadlines_missed(now, 0);
    for (int ms = 1; ms <= 4; ++ms) {
        tick();
        EXPECT_DOUBLE_EQ(commanded_N(), ms);
    }
}

}  // namespace
}  // namespace thimble
