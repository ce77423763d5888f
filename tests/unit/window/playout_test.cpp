#include "visual_node/window/playout.hpp"

#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

// A needle that moves 1 mm per ms, sampled at `stamp`, here after `took`.
Scene moving(Duration stamp, Duration took) {
    return {.position_needle_m = to_seconds(stamp),
            .position_surface_m = 100,
            .sample_time = at(stamp + took),
            .hand_time = at(stamp)};
}

TEST(Playout, WithoutSmoothingShowsTheNewestAsItIs) {
    Playout playout(Duration::zero());
    EXPECT_FALSE(playout.at(at(milliseconds{5}))) << "nothing before the first";
    playout.add(moving(milliseconds{10}, milliseconds{5}));
    playout.add(moving(milliseconds{11}, milliseconds{9}));
    EXPECT_EQ(playout.at(at(milliseconds{20})).value().position_needle_m, 0.011);
}

// Samples every ms, arrivals torn apart by up to 8 ms of jitter: the frames of a steady motion must advance steadily.
TEST(Playout, TakesJitterOutOfTheMotion) {
    const auto jerk = [](Duration smoothing) {
        Playout playout(smoothing);
        double last_m = 0, worst_m = 0;
        int next = 0;
        SessionTime free{};
        for (int frame = 1; frame <= 60; ++frame) {
            const SessionTime now = at(microseconds{16667 * frame});
            while (true) {
                const Duration jitter = microseconds{(next * 7919) % 8000};
                const SessionTime arrival =
                    std::max(free, at(milliseconds{next}) + milliseconds{20} + jitter);
                if (arrival > now) break;
                Scene scene = moving(milliseconds{next}, Duration::zero());
                scene.sample_time = free = arrival;
                playout.add(scene);
                ++next;
            }
            const auto shown = playout.at(now);
            if (frame > 10)
                worst_m = std::max(worst_m, std::abs(shown.value().position_needle_m - last_m - 0.016667));
            last_m = shown ? shown->position_needle_m : 0;
        }
        return worst_m;
    };
    EXPECT_GT(jerk(Duration::zero()), 0.8e-3);
    EXPECT_LT(jerk(milliseconds{15}), 1e-6);
}

// Needles at 20 moments of a trial with this delay; `first`: that of a trial before it.
std::vector<double> shown_with(Duration delay, std::optional<Duration> first) {
    Playout playout(milliseconds{10});
    for (int i = 0; first && i < 100; ++i) playout.add(moving(milliseconds{i}, *first));
    std::vector<double> shown;
    for (int i = 0; i < 100; ++i) {
        Scene scene = moving(milliseconds{5000 + i}, delay);
        scene.trial = 1;
        playout.add(scene);
        if (i % 5 == 0) shown.push_back(playout.at(scene.sample_time).value().position_needle_m);
    }
    return shown;
}

TEST(Playout, TheOrderOfTrialsMakesNoDifference) {
    for (const Duration delay : {milliseconds{1}, milliseconds{50}}) {
        const auto alone = shown_with(delay, {});
        EXPECT_EQ(shown_with(delay, milliseconds{1}), alone);
        EXPECT_EQ(shown_with(delay, milliseconds{50}), alone);
    }
}

TEST(Playout, AQuickerNetworkOfBeforeIsForgotten) {
    Playout playout(milliseconds{10});
    const auto lag_m = [&](int i, Duration delay) {
        playout.add(moving(milliseconds{i}, delay));
        return 0.001 * i - playout.at(at(milliseconds{i} + delay)).value().position_needle_m;
    };
    double before_m = 0, after_m = 0;
    for (int i = 0; i < 1000; ++i) before_m = lag_m(i, milliseconds{1});
    for (int i = 1000; i < 3000; ++i) after_m = lag_m(i, milliseconds{50});
    EXPECT_NEAR(before_m, 0.010, 1e-9);
    EXPECT_NEAR(after_m, 0.010, 1e-9) << "smoothed again";
}

TEST(Playout, StandsStillPastTheNewest) {
    Playout playout(milliseconds{5});
    playout.add(moving(milliseconds{10}, milliseconds{1}));
    playout.add(moving(milliseconds{11}, milliseconds{1}));
    EXPECT_EQ(playout.at(at(milliseconds{500})).value().position_needle_m, 0.011);
}

TEST(Playout, NeverPutsTheNeedleBeneathTheSurface) {
    Playout playout(milliseconds{5});
    for (int i = 0; i < 40; ++i) {
        Scene scene = moving(milliseconds{i}, milliseconds{1});
        scene.position_surface_m = 0.01 * (i % 3);
        scene.position_needle_m = scene.position_surface_m;
        playout.add(scene);
        const auto shown = playout.at(at(microseconds{1000 * i + 300}));
        EXPECT_LE(shown.value().position_needle_m, shown.value().position_surface_m);
    }
}

TEST(Playout, BeginsAnewWhenStampsFall) {
    Playout playout(milliseconds{5});
    for (int i = 100; i < 120; ++i) playout.add(moving(milliseconds{i}, milliseconds{1}));
    playout.add(moving(milliseconds{2}, milliseconds{130}));
    EXPECT_EQ(playout.at(at(milliseconds{133})).value().position_needle_m, 0.002);
}

}  // namespace
}  // namespace thimble
