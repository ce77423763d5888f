// A scene whose clock has run for long. An offset within a step is a difference of two times on that clock, so it
// carries their rounding: half a unit in the last place each, 1.2e-10 s together at 1e6 s. Values that do not depend
// on the clock carry none.
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "common/time.hpp"
#include "slave_sim/needle_scene.hpp"
#include "slave_sim/scene_file.hpp"
#include "slave_sim/solvers.hpp"

namespace thimble {
namespace {

constexpr Duration kStep = std::chrono::milliseconds(1);

struct Seen {
    std::int64_t step;
    double start_s;
    double offset_s;
    std::string what;
};

// As the slave does it: integer nanoseconds since the trial's first command, made seconds for each step.
class Clocked {
  public:
    Clocked(const std::string& scene, Duration start, double needle_m)
        : scene_(read_scene(ConfigFile::parse(scene, "test"), "test"), solver_maker({})), now_(start) {
        scene_.reset({needle_m, needle_m});
    }

    void to(double needle_m, Duration duration = kStep) {
        scene_.clear_transitions();
        scene_.step(to_seconds(now_), to_seconds(duration), {needle_m, needle_m});
        for (const Transition& t : scene_.transitions()) {
            seen_.push_back({steps_, to_seconds(now_), t.offset_s,
                             scene_.element_name(t.element) + " " + std::string(t.phase)});
        }
        now_ += duration;
        ++steps_;
    }
    const std::vector<Seen>& seen() const { return seen_; }

  private:
    NeedleScene scene_;
    Duration now_;
    std::int64_t steps_ = 0;
    std::vector<Seen> seen_;
};

// The distance of two neighbouring doubles there.
double grain_s(double time_s) {
    return std::nextafter(time_s, std::numeric_limits<double>::infinity()) - time_s;
}

class HardClock : public testing::TestWithParam<std::int64_t> {
  protected:
    Duration start() const { return std::chrono::seconds(GetParam()); }
    double start_s() const { return static_cast<double>(GetParam()); }
    double resolution_s() const { return 2 * grain_s(start_s() + 10); }
};
INSTANTIATE_TEST_SUITE_P(Seconds, HardClock, testing::Values(0, 1000, 1'000'000, 900'000'000));

// Changes 10 steps later, at places within a step and on its two ends: each comes once, when it is due.
TEST_P(HardClock, AFixtureChangesWhenItsTimeHasCome) {
    for (const std::int64_t after_ns : {10'250'000, 10'000'001, 10'999'999, 10'000'000, 10'333'333}) {
        const auto due = start() + std::chrono::nanoseconds(after_ns);
        // Seconds and nanoseconds as they would be written in a scene file.
        const std::string due_s = fmt::format("{}.{:09}", GetParam(), after_ns);
        Clocked run("[fixture]\nposition_m = 0.5\n[[fixture.event]]\ntime_s = " + due_s + "\n", start(),
                    0.75);
        for (int i = 0; i < 1000; ++i) run.to(0.75);
        ASSERT_EQ(run.seen().size(), 3u) << due_s;
        EXPECT_EQ(run.seen()[0].what, "fixture touched");
        EXPECT_EQ(run.seen()[1].what, "fixture removed");
        EXPECT_EQ(run.seen()[2].what, "fixture left");
        const Seen& removed = run.seen()[1];
        const double truth_s = to_seconds(due - (start() + kStep * removed.step));
        EXPECT_NEAR(removed.offset_s, truth_s, resolution_s()) << due_s;
        EXPECT_EQ(run.seen()[2].offset_s, removed.offset_s);
    }
}

// Touched a quarter into the third step; gone half a second after that.
TEST_P(HardClock, UnbrokenContactLastsAsLongAsItShould) {
    Clocked run("[fixture]\nposition_m = 0.5\n[[fixture.event]]\nafter_contact_s = 0.5\n", start(), 0.25);
    run.to(0.25);
    run.to(0.25);
    run.to(1.25);
    for (int i = 0; i < 1000; ++i) run.to(1.25);
    ASSERT_EQ(run.seen().size(), 3u);
    EXPECT_EQ(run.seen()[0].what, "fixture touched");
    EXPECT_NEAR(run.seen()[0].offset_s, 0.00025, 1e-18);
    const Seen& removed = run.seen()[1];
    EXPECT_NEAR(1e-3 * static_cast<double>(removed.step) + removed.offset_s, 0.50225, 2 * resolution_s());
}

// Contact and puncture are found within the step: the clock is not asked, and every bit is the same.
TEST_P(HardClock, WhatTheNeedleDoesDoesNotDependOnTheClock) {
    const std::string scene =
        "[[tissue]]\n[[tissue]]\nrest_position_m = 0.04\n[fixture]\nposition_m = 0.07\n";
    Clocked early(scene, Duration::zero(), 0);
    Clocked late(scene, start(), 0);
    for (int i = 1; i <= 4000; ++i) {
        const double needle_m = 0.05 - 0.05 * std::cos(0.00314 * i);
        early.to(needle_m);
        late.to(needle_m);
    }
    ASSERT_EQ(early.seen().size(), late.seen().size());
    EXPECT_GE(early.seen().size(), 8u);
    for (std::size_t i = 0; i < early.seen().size(); ++i) {
        EXPECT_EQ(early.seen()[i].step, late.seen()[i].step);
        EXPECT_EQ(early.seen()[i].offset_s, late.seen()[i].offset_s);
        EXPECT_EQ(early.seen()[i].what, late.seen()[i].what);
    }
}

}  // namespace
}  // namespace thimble
