// The swarm finds nothing where nothing is broken, and finds and shrinks what a test breaks.
#include "study/swarm/swarm.hpp"

#include <cstdlib>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "study/swarm/shrink.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

std::string all_text(const SwarmResult& result) {
    std::string text;
    for (const SwarmFailure& failure : result.failures)
        text += failure_text(failure) + case_text(failure.smallest);
    return text;
}

SwarmResult swarm(std::uint64_t seed, std::uint64_t trials, const BreakForce& break_force = {}) {
    SwarmOptions options;
    options.seed = seed;
    options.trials = trials;
    options.break_force = break_force;
    options.most_failures = 1;
    return run_swarm(options);
}

// How many: THIMBLE_SWARM_TRIALS (docs/reliability.md).
TEST(Swarm, NoDrawnSessionBreaksAnInvariant) {
    const char* wanted = std::getenv("THIMBLE_SWARM_TRIALS");
    const std::uint64_t trials =
        wanted == nullptr ? THIMBLE_SWARM_TRIALS : std::strtoull(wanted, nullptr, 10);
    const SwarmResult result = swarm(1, trials);
    EXPECT_TRUE(result.failures.empty()) << all_text(result);
    EXPECT_EQ(result.cases, trials);
    for (std::size_t kind = 0; kind < result.faults.size() && trials >= 500; ++kind)
        EXPECT_GT(result.faults.at(kind), 0U) << kFaultNames.at(kind);
}

// The device gives more than the command, with a compensator. The smallest case has that key and no fault.
TEST(Swarm, FindsADeviceThatDoesTooMuchAndShrinksToItsKey) {
    const auto broken = [](const SystemSettings& settings, double force_N) {
        return settings.master.control.compensator != Compensator::kNone ? 100 * force_N : force_N;
    };
    const SwarmResult result = swarm(1, 1500, broken);
    ASSERT_FALSE(result.failures.empty());
    const SwarmFailure& first = result.failures.front();
    EXPECT_EQ(first.violation.rule, Rule::kForceLimit);
    EXPECT_TRUE(first.smallest.faults.empty()) << case_text(first.smallest);
    EXPECT_LE(first.smallest.keys.size(), 3U) << case_text(first.smallest);
    EXPECT_THAT(case_text(first.smallest), HasSubstr("compensator = \""));
}

// A device that goes on with the last force breaks the rules of silence; which fault is needed remains.
TEST(Swarm, FindsAForceThatStays) {
    double last_N = 0;
    const auto broken = [&last_N](const SystemSettings& /*settings*/, double force_N) {
        if (force_N != 0) last_N = force_N;
        return last_N;
    };
    SwarmOptions options;
    options.trials = 50;
    options.most_failures = 1;
    options.jobs = 1;
    options.break_force = broken;
    const SwarmResult result = run_swarm(options);
    ASSERT_FALSE(result.failures.empty());
    SwarmCase again = result.failures.front().smallest;
    EXPECT_TRUE(run_case(again, broken).violation);
    EXPECT_FALSE(run_case(again).violation);
}

TEST(Swarm, ASeedIsOneCaseWithTheSameBits) {
    const auto keys = drawable_keys();
    for (const std::uint64_t seed : {3U, 14U, 159U}) {
        SwarmCase one = draw_case(keys, seed), other = draw_case(keys, seed);
        EXPECT_EQ(case_text(one), case_text(other));
        EXPECT_EQ(run_case(one).digest, run_case(other).digest);
    }
}

// A trial without a force at the handle has bits to compare as well.
TEST(SwarmWatch, TheDigestHasFingerSceneAndSample) {
    const SystemSettings settings = load_system_settings({});
    Watch watch(settings, false);
    std::set<std::uint64_t> digests{watch.digest()};
    watch.finger_commanded({}, 0.5);
    EXPECT_TRUE(digests.insert(watch.digest()).second) << "finger";
    Scene scene;
    scene.position_needle_m = 0.01;
    watch.bar_drawn({}, scene);
    EXPECT_TRUE(digests.insert(watch.digest()).second) << "scene";
    watch.sample_recorded({0.001, 0.01});
    EXPECT_TRUE(digests.insert(watch.digest()).second) << "sample";
}

TEST(SwarmWatch, AStopMustHoldAlsoAfterTheReleaseOfAnEarlierOne) {
    const SystemSettings settings = load_system_settings({});
    Watch watch(settings, false);
    VirtualSession session(settings);
    watch.look_at(session);
    const auto run_for = [&](Duration time) {
        for (const SessionTime end = session.now() + time; session.now() < end && session.loop().step();)
            watch.instant();
    };
    session.emergency_stop(Role::kMaster, "the first");
    run_for(std::chrono::seconds{1});
    watch.release();
    session.release_stop();
    run_for(std::chrono::seconds{2});
    session.emergency_stop(Role::kMaster, "the second");
    run_for(std::chrono::seconds{1});
    ASSERT_FALSE(watch.violation()) << watch.violation()->text;
    session.restart(Role::kVisual);  // without the stop, and without a word to the watch
    watch.instant();
    ASSERT_TRUE(watch.violation());
    EXPECT_EQ(watch.violation()->rule, Rule::kStopHolds);
}

TEST(Swarm, WritesTheSmallestSessionThatFails) {
    const Folder folder;
    SwarmOptions options;
    options.out = folder / "swarm";
    options.trials = 30;
    options.most_failures = 1;
    options.break_force = [](const SystemSettings&, double force_N) { return force_N + 1; };
    const SwarmResult result = run_swarm(options);
    ASSERT_FALSE(result.failures.empty());
    const SwarmFailure& first = result.failures.front();
    EXPECT_THAT(failure_text(first), HasSubstr(fmt::format("thimble swarm --seed {}", first.seed)));
    EXPECT_NO_THROW(load_system_settings(first.file));
}

TEST(Swarm, TheManualHasEveryRule) {
    const std::string manual = read_text(std::filesystem::path(THIMBLE_SOURCE_DIR) / "docs/safety.md");
    for (const Invariant& rule : kInvariants)
        EXPECT_THAT(manual, HasSubstr(fmt::format("| `{}` | {} |", rule.name, rule.text)));
}

TEST(DrawnKeys, AKeyThatAReaderAsksForIsDrawnToo) {
    const auto keys = drawable_keys();
    int timelines = 0;
    for (std::uint64_t seed = 1; seed < 100; ++seed)
        timelines += case_text(draw_case(keys, seed)).find(".timeline]]") != std::string::npos ? 1 : 0;
    EXPECT_GT(timelines, 5);
}

}  // namespace
}  // namespace thimble
