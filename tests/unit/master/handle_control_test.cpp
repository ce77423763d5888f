// A compensator in the master's loop: which force a sample gets.
#include "master/handle_control.hpp"

#include <algorithm>
#include <deque>

#include <gtest/gtest.h>

namespace thimble {
namespace {

using std::chrono::milliseconds;

constexpr HandleControlScale kPaperScale{};

ForceFeedback pushes(double force_N, double needle_m = 0.12) {
    return {.position_needle_m = needle_m, .force_fixture_N = -force_N, .force_total_N = -force_N};
}

ControlSettings of(Compensator compensator) {
    ControlSettings settings;
    settings.compensator = compensator;
    return settings;
}

// In a trial of the handle modality.
struct Started : HandleControl {
    explicit Started(Compensator compensator) : HandleControl(of(compensator), kPaperScale) {
        start(true, {});
    }
};

TEST(HandleControl, WorksInTheHandleModalityOnly) {
    for (std::size_t i = 0; i < kBuiltInCompensators.size(); ++i) {
        const auto compensator = static_cast<Compensator>(i);
        HandleControl control(of(compensator), kPaperScale);
        control.start(false, {});
        EXPECT_FALSE(control.active());
        control.start(true, {});
        EXPECT_EQ(control.present(), compensator != Compensator::kNone) << kCompensatorNames[i];
        const bool at_once =
            compensator == Compensator::kScaled || compensator == Compensator::kPredictedShare;
        EXPECT_EQ(control.active(), compensator != Compensator::kNone && !at_once) << kCompensatorNames[i];
        EXPECT_EQ(control.waves(), compensator == Compensator::kWave ||
                                       compensator == Compensator::kTwoPort ||
                                       compensator == Compensator::kFourChannel)
            << kCompensatorNames[i];
        control.end();
        EXPECT_FALSE(control.present());
    }
}

TEST(HandleControl, AWishIsMetAsFarAsTheBoundAllows) {
    Started control(Compensator::kLeastConservative);
    control.sample(SessionTime{}, {0, 0});
    control.take(pushes(5));
    EXPECT_EQ(control.force_N(), 0) << "nothing has been put in";
    control.sample(SessionTime{milliseconds{1}}, {1e-3, 0});  // 0.5 mJ against the device's damping
    EXPECT_DOUBLE_EQ(control.force_N(), 1);
    control.sample(SessionTime{milliseconds{2}}, {1e-2, 0});
    EXPECT_EQ(control.force_N(), 5);
    control.take(pushes(100));
    EXPECT_LE(control.force_N(), 12);
    ForceFeedback held = pushes(5);
    held.needle_held = true;
    control.take(held);
    EXPECT_EQ(control.force_N(), 0);
}

TEST(HandleControl, ALocalFixtureActsAtOnceAndIsForgottenInSilence) {
    Started control(Compensator::kLocalFixture);
    control.sample(SessionTime{}, {0.039, 0});
    EXPECT_EQ(control.force_N(), 0);
    control.take(pushes(3, 0.12));  // at 40 mm of hand with 3 N: the plane is at 39 mm
    EXPECT_EQ(control.force_N(), 0);
    control.sample(SessionTime{milliseconds{1}}, {0.0395, 0});
    EXPECT_NEAR(control.force_N(), 1.5, 1e-9);
    control.take(ForceFeedback{.needle_held = true});
    EXPECT_EQ(control.force_N(), 0);
    ForceFeedback strong = pushes(3);
    strong.force_tissue_N = -kPaperScale.force_limit_N;
    control.take(strong);
    control.sample(SessionTime{milliseconds{2}}, {0.0405, 0});
    EXPECT_EQ(control.force_N(), kPaperScale.force_limit_N) << "no more than the handle may get";
    control.forget();
    EXPECT_EQ(control.force_N(), 0);
}

// The tick of the sample cannot know its own answer: one wave later at the least.
TEST(HandleControl, WavesArePlayedWhenTheNetworkWasExpectedToBringThem) {
    ControlSettings settings = of(Compensator::kWave);
    settings.jitter = {};
    settings.channel.repeats = 0;
    for (const int delay_ms : {0, 10}) {
        HandleControl control(settings, kPaperScale);
        control.start(true, milliseconds{delay_ms});
        const int due = std::max(1, delay_ms);
        for (int n = 0; n < 2 * due + 2; ++n) {
            control.sample(SessionTime{milliseconds{n}}, {0, 0});
            EXPECT_EQ(control.burst().number, static_cast<std::uint32_t>(n));
            EXPECT_EQ(control.force_N() != 0, n >= due) << delay_ms << ' ' << n;
            control.take(
                WaveBurst{.wave_root_W = {-0.1}, .number = static_cast<std::uint32_t>(n), .count = 1});
        }
        EXPECT_GT(control.force_N(), 0) << "waves that come back negative push the hand out";
    }
}

// Returns waves over a network that keeps their order. The session tells the handle about each change of that network.
class WavesOverANetwork {
  public:
    explicit WavesOverANetwork(Duration delay) : delay_(delay) { control_.start(true, delay); }
    // From the next sample on.
    void change(Duration delay) {
        delay_ = delay;
        tell(delay);
    }
    void tell(Duration delay) { control_.network_changed(delay); }
    // The force of the next sample. `wave_root_W` is what the slave answers to it.
    double sample(double wave_root_W) {
        const SessionTime now{milliseconds{samples_++}};
        control_.sample(now, {0, 0});
        newest_ = std::max(newest_, now + delay_);
        under_way_.push_back(
            {newest_, {.wave_root_W = {wave_root_W}, .number = control_.burst().number, .count = 1}});
        for (; !under_way_.empty() && under_way_.front().comes <= now; under_way_.pop_front())
            control_.take(under_way_.front().burst);
        return control_.force_N();
    }

  private:
    struct UnderWay {
        SessionTime comes;
        WaveBurst burst;
    };
    HandleControl control_{of(Compensator::kWave), kPaperScale};
    Duration delay_;
    SessionTime newest_{};
    std::deque<UnderWay> under_way_;
    int samples_ = 0;
};

TEST(HandleControl, WavesWaitForAChangedNetworkAndNoLonger) {
    WavesOverANetwork waves(milliseconds{10});
    const auto run = [&](int samples) {
        int without_force = 0;
        for (int i = 0; i < samples; ++i) without_force += waves.sample(-0.1) > 0 ? 0 : 1;
        return without_force;
    };
    const int wait = 10 + 2 + 3;  // samples: the network, wave_jitter_s, wave_repeats
    EXPECT_EQ(run(300), wait);
    waves.change(milliseconds{200});
    EXPECT_EQ(run(1000), 190) << "nothing is under way that could be played meanwhile";
    waves.change(milliseconds{30});
    EXPECT_EQ(run(1000), 0) << "what was under way is still waited for";
    const double before_N = waves.sample(-0.2);
    int samples = 1;
    while (waves.sample(-0.2) == before_N) ++samples;
    EXPECT_EQ(samples, 30 + 2 + 3);
}

TEST(HandleControl, TheSameNetworkToldAgainChangesNothing) {
    WavesOverANetwork told(milliseconds{50}), untold(milliseconds{50});
    for (int n = 0; n < 1000; ++n) {
        if (n % 100 == 99) told.tell(milliseconds{50});
        const double wave_root_W = -1e-3 * (n % 83);
        ASSERT_EQ(told.sample(wave_root_W), untold.sample(wave_root_W)) << n;
    }
}

TEST(HandleControl, ATrialKnowsNothingOfTheOneBefore) {
    for (std::size_t i = 1; i < kBuiltInCompensators.size(); ++i) {
        HandleControl used(of(static_cast<Compensator>(i)), kPaperScale),
            fresh(of(static_cast<Compensator>(i)), kPaperScale);
        used.start(true, {});
        for (int ms = 0; ms < 20; ++ms) {
            used.sample(SessionTime{milliseconds{ms}}, {1e-3 * ms, 2});
            used.take(pushes(7));
        }
        used.end();
        used.start(true, {});
        fresh.start(true, {});
        EXPECT_EQ(used.force_N(), fresh.force_N()) << kCompensatorNames[i];
        for (int ms = 1000; ms < 1020; ++ms) {
            for (HandleControl* each : {&used, &fresh}) {
                each->sample(SessionTime{milliseconds{ms}}, {1e-3 * (ms - 990), 1});
                each->take(pushes(3));
            }
            ASSERT_EQ(used.force_N(), fresh.force_N()) << kCompensatorNames[i];
        }
    }
}

thimble_handle told{};  // the newest sample, to a controller of the user

thimble_controller listener() {
    thimble_controller table{};
    table.create = [](const thimble_controller_settings*) -> void* { return &told; };
    table.destroy = [](void*) {};
    table.start = [](void*, double) {};
    table.sample = [](void*, const thimble_handle* handle, thimble_packet*) { told = *handle; };
    table.force = [](void*, const thimble_feedback*) { return 0.0; };
    return table;
}

TEST(HandleControl, TheTimeOfEachTrialBeginsAtZero) {
    const thimble_controller table = listener();
    ControlSettings settings = of(Compensator::kPlugin);
    settings.plugin.table = &table;
    HandleControl control(settings, kPaperScale);
    for (const int begin_ms : {0, 5000}) {
        control.start(true, {});
        for (const int ms : {0, 3}) {
            control.sample(SessionTime{milliseconds{begin_ms + ms}}, {0, 0});
            EXPECT_DOUBLE_EQ(told.time_s, 1e-3 * ms);
            EXPECT_DOUBLE_EQ(told.elapsed_s, 1e-3 * ms);
        }
    }
}

}  // namespace
}  // namespace thimble
