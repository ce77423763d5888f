// The swarm finds nothing where nothing is broken, and finds and shrinks what a test breaks.
#include "study/swarm/swarm.hpp"

#include <cstdlib>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

SwarmResult swarm(std::uint64_t seed, std::uint64_t trials, const BreakForce& break_force = {},
                  unsigned jobs = 0) {
    SwarmOptions options;
    options.seed = seed;
    options.cases = trials;
    options.jobs = jobs;
    options.break_force = break_force;
    options.most_failures = 1;
    if (!break_force) options.plugin = THIMBLE_PLUGINS "/mine.so";
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

// Cases that the swarm once took for broken, after shrinking.
SwarmCase case_of(std::uint64_t seed, DrawnKeys keys, std::vector<SwarmFault> faults = {}) {
    return {seed, std::move(keys), std::move(faults)};
}

SwarmFault fault_of(FaultKind kind, Role role, Port port, double at_s, double length_s, double value) {
    return {kind, role, port, SessionTime{from_seconds(at_s)}, from_seconds(length_s), value};
}

SwarmOutcome run(SwarmCase one) {
    const std::size_t given = one.keys.size();
    SwarmOutcome outcome = run_case(one);
    EXPECT_EQ(one.keys.size(), given) << "a reader refused a key, so this was another case";
    EXPECT_FALSE(outcome.violation) << outcome.violation->text << '\n' << case_text(one);
    return outcome;
}

// slave_sim's forces and its hold are beyond what a message may say, so every node refuses them.
TEST(Swarm, ALoopThatDivergesIsNotANeedleThatIsNotHeld) {
    const SwarmOutcome outcome =
        run(case_of(3016489, {{"operator.reflex_gain", "2"}, {"session.delays_s", "[0.05]"}}));
    EXPECT_EQ(outcome.ends, std::vector{EndReason::kPeerLost});
}

// Forces that came late were dropped, but the one before them never faded. The node was wrong, not the check.
TEST(Swarm, AForceFadesAlsoWhereAllOthersComeLate) {
    run(case_of(4091285, {{"codec.command", "\"send-on-delta\""},
                          {"master.stale_after_s", "0.00366711"},
                          {"netem.needle.timeline[].at_s", "0.00452909"},
                          {"netem.needle.timeline[].slot_most_s", "0.0450596"}}));
}

// A copy of a command becomes a new command.
TEST(Swarm, ACopyOfACommandWithFlippedBitsGivesNoSecondSample) {
    run(case_of(3017903,
                {{"netem.needle.timeline[].duplicate", "1"}, {"netem.needle.timeline[].at_s", "0.00360275"}},
                {fault_of(FaultKind::kCorrupt, {}, Port{14}, 1.354, 0.2879, 0.438)}));
}

// It holds no needle before its first command.
TEST(Swarm, ASlaveThatHasRestartedMayWaitForACommand) {
    run(case_of(3095407, {},
                {fault_of(FaultKind::kRestart, Role::kSlaveSim, {}, 1.0232, 0.1341, 0.3522),
                 fault_of(FaultKind::kRestart, Role::kCutaneous, {}, 0, 1.5814, 0.337)}));
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
    const SwarmResult result = swarm(1, 50, broken, 1);
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
    options.cases = 30;
    options.most_failures = 1;
    options.plugin = THIMBLE_PLUGINS "/mine.so";
    options.break_force = [](const SystemSettings&, double force_N) { return force_N + 1; };
    const SwarmResult result = run_swarm(options);
    ASSERT_FALSE(result.failures.empty());
    const SwarmFailure& first = result.failures.front();
    const std::string again =
        fmt::format("thimble swarm --seed {} --plugin {}", first.seed, options.plugin.string());
    EXPECT_THAT(failure_text(first), HasSubstr(again));
    EXPECT_THAT(read_text(first.file), HasSubstr(again));
    EXPECT_NO_THROW(load_system_settings(first.file));
}

TEST(Swarm, TheManualHasEveryRule) {
    const std::string manual = read_text(std::filesystem::path(THIMBLE_SOURCE_DIR) / "docs/safety.md");
    for (const Invariant& rule : kInvariants)
        EXPECT_THAT(manual, HasSubstr(fmt::format("| `{}` | {} |", rule.name, rule.text)));
}

TEST(DrawnKeys, SomeSessionsHaveACodecOrAPlugin) {
    const auto keys = drawable_keys(THIMBLE_PLUGINS "/mine.so");
    std::map<std::string, int> drawn;
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        SwarmCase one = draw_case(keys, seed);
        const SystemSettings settings = settings_of(one.keys);
        for (const HapticCodec codec : {settings.master.codec.command, settings.master.codec.force})
            ++drawn[std::string(kHapticCodecNames.at(static_cast<std::size_t>(codec)))];
        if (settings.master.control.compensator == Compensator::kPlugin) ++drawn["plug-in"];
    }
    for (const std::string_view name : kHapticCodecNames) EXPECT_GT(drawn[std::string(name)], 3) << name;
    EXPECT_GT(drawn["plug-in"], 5);
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
