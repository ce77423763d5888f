#include "cutaneous_node/cutaneous_node.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "cutaneous_node/cutaneous_process.hpp"
#include "cutaneous_node/cutaneous_settings.hpp"
#include "cutaneous_node/simulated_actuator.hpp"
#include "tests/refusal.hpp"
#include "tests/unit/cutaneous_node/drive_bench.hpp"
#include "tests/unit/queue_ports.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

SessionControl trial(Modality modality) { return {.kind = ControlKind::kTrialStart, .modality = modality}; }

ForceFeedback force(double total_N, bool held = false) {
    return {.force_total_N = total_N, .needle_held = held};
}

// A device that records its commands and obeys at once.
class NotingActuator final : public FingertipActuator {
  public:
    void command(SessionTime now, Finger finger, double force_N) override {
        current = {finger, force_N, now};
        ++commands;
    }
    FingertipForce output(SessionTime) override { return current; }
    void release(SessionTime now) override {
        current = {Finger::kNone, 0, now};
        ++releases;
    }
    void use_hand(SessionTime, Hand which) override { hand = which; }
    void tick(SessionTime) override { ticked_N = current.force_N; }
    SessionTime next_wakeup() const override { return kNever; }
    std::string_view fault() const override { return {}; }

    Hand hand = Hand::kActing;
    FingertipForce current;
    double ticked_N = 0;  // that its own cycle, within a tick of the program, would send to motors
    int commands = 0;
    int releases = 0;
};

// The node before a device, both driven by milliseconds.
template <class Actuator = NotingActuator>
struct Bench {
    explicit Bench(const CutaneousSettings& settings, Modality modality = Modality::kCF)
        : actuator(make(settings)), node(settings, actuator) {
        start(0, modality);
    }
    explicit Bench(Modality modality) : Bench(CutaneousSettings{}, modality) {}
    static Actuator make(const CutaneousSettings& settings) {
        if constexpr (std::is_same_v<Actuator, NotingActuator>) {
            return {};
        } else {
            return Actuator(settings);
        }
    }
    void start(int ms, Modality modality) {
        const SessionTime now = at(milliseconds{ms});
        node.start_trial(now, trial(modality), now);
    }
    void feed(int ms, const ForceFeedback& feedback) {
        node.on_feedback(at(milliseconds{ms}), at(milliseconds{ms}), feedback);
    }
    void feed(int ms, double total_N) { feed(ms, force(total_N)); }
    double felt_N(int ms) { return node.percept(at(milliseconds{ms}))->force_N; }

    Actuator actuator;
    CutaneousNode node;
};

TEST(CutaneousNode, PushingInPressesTheIndexFingerPullingOutTheThumb) {
    Bench bench(Modality::kCF);
    int ms = 0;
    for (const auto& [total_N, finger] :
         {std::pair{-0.7, Finger::kIndex}, {0.3, Finger::kThumb}, {0.0, Finger::kNone}}) {
        bench.feed(++ms, total_N);
        EXPECT_EQ(bench.actuator.current.finger, finger);
        EXPECT_EQ(bench.actuator.current.force_N, std::abs(total_N));
    }
}

TEST(CutaneousNode, OnlyCutaneousModalitiesPress) {
    for (const Modality modality : kModalities) {
        Bench bench(modality);
        bench.feed(0, -1);
        const bool pressed = modality == Modality::kCF || modality == Modality::kCCF;
        EXPECT_EQ(bench.node.active(), pressed);
        EXPECT_EQ(bench.actuator.commands, pressed ? 1 : 0);
        EXPECT_EQ(bench.node.percept(at({})).has_value(), pressed);
        EXPECT_EQ(bench.node.next_percept(), pressed ? at(milliseconds{1}) : kNever);
        EXPECT_EQ(bench.actuator.hand, modality == Modality::kCCF ? Hand::kOther : Hand::kActing);
    }
}

// [control] compensator = "scaled"
TEST(CutaneousNode, PressesWhatTheHandleDoesNotGive) {
    Bench bench(CutaneousSettings{.hand_share = 0.25}, Modality::kHF);
    EXPECT_EQ(bench.actuator.hand, Hand::kActing);
    bench.feed(0, -2);
    EXPECT_EQ(bench.actuator.current.force_N, 1.5);
    bench.start(1, Modality::kCF);
    bench.feed(1, -2);
    EXPECT_EQ(bench.actuator.current.force_N, 2);
}

TEST(CutaneousNode, IsSlackOutsideTrialsAndWhereAnotherModalityBegins) {
    NotingActuator actuator;
    CutaneousNode node(CutaneousSettings{}, actuator);
    EXPECT_FALSE(node.active());
    EXPECT_FALSE(node.presses());
    node.on_feedback(at({}), at({}), force(-1));
    EXPECT_EQ(actuator.commands, 0);
    node.start_trial(at({}), trial(Modality::kCF), at({}));
    node.on_feedback(at({}), at({}), force(-1));
    node.end_trial(at(milliseconds{1}));
    EXPECT_EQ(actuator.current.finger, Finger::kNone);
    EXPECT_FALSE(node.active());
    EXPECT_FALSE(node.percept(at(milliseconds{2})).has_value());
    node.on_feedback(at(milliseconds{2}), at(milliseconds{2}), force(-1));
    EXPECT_EQ(actuator.commands, 1);
    Bench bench(Modality::kCCF);
    bench.feed(0, -1);
    bench.start(1, Modality::kHF);
    EXPECT_EQ(bench.actuator.current.finger, Finger::kNone);
}

TEST(CutaneousNode, LetsGoWhenFeedbackStops) {
    Bench bench(Modality::kCF);
    bench.feed(10, -1);
    const int before = bench.actuator.releases;
    EXPECT_EQ(bench.node.percept(at(milliseconds{110} - Duration{1}))->force_N, 1);
    EXPECT_EQ(bench.felt_N(110), 0);
    bench.felt_N(150);
    EXPECT_EQ(bench.actuator.releases, before + 1) << "once is enough";
    bench.feed(160, -0.5);
    EXPECT_EQ(bench.felt_N(160), 0.5);
}

TEST(CutaneousNode, HoldsOrFadesWhereItIsToldTo) {
    for (const StaleMode mode : {StaleMode::kHold, StaleMode::kRamp}) {
        Bench bench(CutaneousSettings{.stale = {mode}});
        bench.feed(0, -0.8);
        for (int ms = 0; ms <= 110; ++ms) bench.felt_N(ms);
        EXPECT_EQ(bench.actuator.current.finger, Finger::kIndex);
        EXPECT_DOUBLE_EQ(bench.actuator.current.force_N, mode == StaleMode::kHold ? 0.8 : 0.4);
        for (int ms = 111; ms <= 121; ++ms) bench.felt_N(ms);
        EXPECT_EQ(bench.actuator.current.force_N, mode == StaleMode::kHold ? 0.8 : 0);
    }
}

// The delay grows by 99 ms, then by 1 ms more: that is late.
TEST(CutaneousNode, AForceThatIsTooLateCountsAsNone) {
    Bench bench(Modality::kCF);
    bench.feed(0, -1);
    bench.node.on_feedback(at(milliseconds{100}), at(milliseconds{1}), force(-0.5));
    EXPECT_EQ(bench.actuator.current.force_N, 0.5);
    EXPECT_FALSE(bench.node.stale(at(milliseconds{200})));
    bench.node.on_feedback(at(milliseconds{201}), at(milliseconds{1}), force(-0.7));
    EXPECT_EQ(bench.actuator.current.force_N, 0.5);
    EXPECT_TRUE(bench.node.stale(at(milliseconds{201})));
    bench.node.network_changed(milliseconds{200});
    bench.node.on_feedback(at(milliseconds{202}), at(milliseconds{2}), force(-0.7));
    EXPECT_EQ(bench.actuator.current.force_N, 0.7);
}

TEST(GuardedActuator, NoFingerIsPressedHarderThanItsLimit) {
    NotingActuator device;
    GuardedActuator guard(2, device);
    for (const double wanted_N : {-1.0, 0.0, 1.5, 2.0, 2.5, 1e300}) {
        guard.command({}, Finger::kIndex, wanted_N);
        EXPECT_EQ(device.current.force_N, std::clamp(wanted_N, 0.0, 2.0));
    }
    for (const double no_number : {std::nan(""), std::numeric_limits<double>::infinity()}) {
        guard.clear({});
        guard.command({}, Finger::kThumb, 1);
        EXPECT_FALSE(guard.tripped());
        guard.command({}, Finger::kThumb, no_number);
        EXPECT_TRUE(guard.tripped());
        EXPECT_EQ(guard.text(), "the force for the fingertip device is not a finite number");
        EXPECT_EQ(device.current.finger, Finger::kNone);
        guard.command({}, Finger::kThumb, 1);
        EXPECT_EQ(device.current.finger, Finger::kNone) << "until it is cleared";
    }
}

TEST(CutaneousNode, LetsGoWhenTheNeedleIsHeld) {
    Bench bench(Modality::kCCF);
    bench.feed(0, -1);
    bench.feed(1, force(-1, true));
    EXPECT_EQ(bench.actuator.current.finger, Finger::kNone);
    const int before = bench.actuator.releases;
    bench.feed(2, force(-1, true));
    EXPECT_EQ(bench.actuator.releases, before);
    EXPECT_EQ(bench.actuator.commands, 1);
}

TEST(CutaneousNode, PerceptsKeepTheirGrid) {
    NotingActuator actuator;
    CutaneousNode node(CutaneousSettings{}, actuator);
    const SessionTime start = at(microseconds{250});
    node.start_trial(start, trial(Modality::kCF), start);
    int percepts = 0;
    for (int i = 0; i < 1000; ++i) {
        percepts += node.percept(start + microseconds{100 * i}).has_value() ? 1 : 0;
    }
    EXPECT_EQ(percepts, 100);
    // A late call counts once and the grid stays.
    EXPECT_TRUE(node.percept(start + microseconds{110'300}).has_value());
    EXPECT_EQ(node.next_percept(), start + microseconds{111'000});
}

TEST(CutaneousNode, PerceptCarriesForceFingerAndAge) {
    Bench<SimulatedActuator> bench(CutaneousSettings{});
    for (int ms = 0; ms <= 100; ++ms) {
        bench.feed(ms, ms < 20 ? -9 : 0.25);
        const auto percept = bench.node.percept(at(milliseconds{ms}));
        ASSERT_TRUE(percept.has_value());
        const Finger expected = ms < 45 ? Finger::kNone : ms < 65 ? Finger::kIndex : Finger::kThumb;
        EXPECT_EQ(percept->finger, expected) << ms;
        EXPECT_EQ(percept->force_N, ms < 45 ? 0 : ms < 65 ? 1.5 : 0.25) << ms;
        EXPECT_DOUBLE_EQ(percept->sample_age_s, ms < 45 ? ms * 1e-3 : 0.045) << ms;
        EXPECT_EQ(percept->bar_N, 0);
        EXPECT_FALSE(percept->beep);
    }
}

TEST(CutaneousNode, NothingOfAnEarlierTrialIsFelt) {
    Bench<SimulatedActuator> bench(CutaneousSettings{});
    for (int ms = 0; ms < 60; ++ms) bench.feed(ms, -1);
    bench.node.end_trial(at(milliseconds{60}));
    bench.start(61, Modality::kCF);
    for (int ms = 61; ms < 150; ++ms) EXPECT_EQ(bench.felt_N(ms), 0) << ms;
}

// The whole process, after a stall of the program and while the policy keeps its outputs at rest.
class RunningCutaneous : public testing::Test {
  protected:
    RunningCutaneous() {
        session.send(now, 1, trial(Modality::kCF));
        tick(milliseconds{0});
        for (int ms = 1; ms <= 10; ++ms) feed_and_tick(-1.2);
    }
    void feed_and_tick(double force_N) {
        slave.send(now, 1, force(force_N));
        tick(milliseconds{1});
    }
    void tick(Duration later) {
        now += later;
        process.tick(now);
    }

    QueuePorts ports;
    NotingActuator actuator;
    CutaneousProcess process{5, {.stale = {StaleMode::kRamp}}, ports, actuator};
    OutboundFlow session{Role::kSession, 1, {ports.far_end(Port::kCutaneousControl)}};
    OutboundFlow slave{Role::kSlaveSim, 2, {ports.far_end(Port::kCutaneousForce)}};
    SessionTime now{};
};

TEST_F(RunningCutaneous, AfterAStallTheFingersStaySlackUntilTheNextForce) {
    ASSERT_EQ(actuator.current.force_N, 1.2);
    const int commands = actuator.commands;
    for (const Duration later : {milliseconds{102}, milliseconds{1}, milliseconds{1}}) {
        tick(later);
        EXPECT_EQ(actuator.current.force_N, 0);
    }
    EXPECT_EQ(actuator.commands, commands) << "not for an instant either";
    feed_and_tick(-0.5);
    EXPECT_EQ(actuator.current.force_N, 0.5);
}

TEST_F(RunningCutaneous, LeavesNoFingerPressed) {
    ASSERT_EQ(actuator.current.force_N, 1.2);
    process.leave(now);
    EXPECT_EQ(actuator.current.finger, Finger::kNone);
    EXPECT_EQ(process.reason(), EndReason::kInterrupted);
    const int releases = actuator.releases;
    process.leave(now);
    EXPECT_EQ(actuator.releases, releases) << "no trial, nothing to leave";
}

TEST_F(RunningCutaneous, AtRestNoForceReachesTheFingersThatComesMeanwhile) {
    process.set_overrun(OverrunPolicy::kRest, 3);
    process.deadlines_missed(now, 3);
    const int commands = actuator.commands;
    for (int ms = 0; ms < 5; ++ms) {
        feed_and_tick(-1.2);
        EXPECT_EQ(actuator.current.force_N, 0);
        EXPECT_EQ(actuator.ticked_N, 0);
    }
    EXPECT_EQ(actuator.commands, commands);
    process.deadlines_missed(now, 0);
    tick(milliseconds{1});
    EXPECT_EQ(actuator.current.force_N, 0) << "until the next force";
    feed_and_tick(-0.7);
    EXPECT_EQ(actuator.current.force_N, 0.7);
    EXPECT_EQ(process.stale_record().trials(), 0U) << "nothing was stale";
}

CutaneousSettings settings_of(const std::string& text) {
    const ConfigFile file = ConfigFile::parse("[cutaneous]\n" + text, "cutaneous.toml");
    const CutaneousSettings settings = read_cutaneous_settings(file.table("cutaneous"));
    file.finish();
    return settings;
}

TEST(CutaneousSettings, DrivesNeedABus) {
    EXPECT_EQ(settings_of("").device, FingertipDevice::kSimulated);
    EXPECT_THROW(settings_of("device = \"drives\""), Error);
    const CutaneousSettings settings = settings_of("device = \"drives\"\n[cutaneous.drives]\nbus = \"can1\"");
    EXPECT_EQ(settings.device, FingertipDevice::kDrives);
    EXPECT_EQ(settings.drives.bus, "can1");
    EXPECT_EQ(settings.drives.fingers.size(), 4U);
}

TEST(CutaneousSettings, TheDeviceIsAskedForNoMoreThanTheGuardLetsThrough) {
    EXPECT_THROW(settings_of("guard_limit_N = 1"), Error);
    EXPECT_THROW(settings_of("force_limit_N = 6"), Error);
    EXPECT_EQ(settings_of("force_limit_N = 6\nguard_limit_N = 6").force_limit_N, 6);
}

// 0.2 N on each of three cables press with 0.56 N.
TEST(CutaneousSettings, PretensionCountsForTheGuardsLimit) {
    const auto drives = [](const std::string& limits) {
        return settings_of(limits + "[cutaneous.drives]\nbus = \"can1\"\npretension_N = 0.2");
    };
    EXPECT_NEAR(drives("guard_limit_N = 2.1\n").drives.resting_N(), 0.564, 0.001);
    EXPECT_THAT(refusal([&] { drives("guard_limit_N = 2\n"); }, ExitCode::kUsage),
                testing::AllOf(testing::HasSubstr("cutaneous.drives.pretension_N"),
                               testing::HasSubstr("0.564 N at rest")));
    EXPECT_NO_THROW(settings_of("guard_limit_N = 1.5\n")) << "no drives";
}

TEST(DriveSettings, RefusesWhatCannotBe) {
    for (const char* text : {"acting_index = [1, 2]", "acting_index = [4, 5, 6]", "acting_index = [1, 2, 2]",
                             "acting_index = [1, 2, 127]", "acting_index = [1, 2, 2.5]",
                             "mode = \"velocity\"", "mode = \"position\"\ncycle_s = 0.00256",
                             "cycle_s = 0.05", "efficiency = 1.2", "node = 3", "listen_port = 20002",
                             "acting_index = []\nacting_thumb = []\nother_index = []\nother_thumb = []"}) {
        EXPECT_THROW(drive_settings(text), Error) << text;
    }
    for (const char* bus : {"cannelloni:", "cannelloni:host", "cannelloni::1", "cannelloni:host:0",
                            "cannelloni:host:99999", "cannelloni:host:1x", "a_name_of_16_char"}) {
        const ConfigFile file = ConfigFile::parse(std::string("bus = \"") + bus + "\"", "x");
        EXPECT_THROW(read_drive_settings(file.root()), Error) << bus;
    }
    const ConfigFile file = ConfigFile::parse("bus = \"cannelloni:lab:20001\"\nlisten_port = 20002", "x");
    const auto address = read_drive_settings(file.root()).cannelloni;
    EXPECT_EQ(drive_settings("cycle_s = 0.00256").master.cycle, microseconds{2560}) << "by torque";
    ASSERT_TRUE(address);
    EXPECT_EQ(address->host, "lab");
    EXPECT_EQ(address->port, 20001);
    EXPECT_EQ(address->listen_port, 20002);
}

}  // namespace
}  // namespace thimble
