// The fingers after a stall of the program, and while the policy keeps its outputs at rest.
#include "cutaneous_node/cutaneous_process.hpp"

#include <gtest/gtest.h>

#include "common/queue_channel.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

// A device without lag.
class ObedientActuator final : public FingertipActuator {
  public:
    void command(SessionTime now, Finger finger, double force_N) override {
        pressed = {finger, force_N, now};
        ++commands;
    }
    FingertipForce output(SessionTime) override { return pressed; }
    void release(SessionTime now) override { pressed = {Finger::kNone, 0, now}; }
    void use_hand(SessionTime, Hand) override {}
    void tick(SessionTime) override { ticked_N = pressed.force_N; }
    SessionTime next_wakeup() const override { return kNever; }
    std::string_view fault() const override { return {}; }

    FingertipForce pressed;
    double ticked_N = 0;  // that its own cycle, within a tick of the program, would send to motors
    int commands = 0;
};

CutaneousSettings ramping() {
    CutaneousSettings settings;
    settings.stale.mode = StaleMode::kRamp;
    return settings;
}

class RunningCutaneous : public testing::Test {
  protected:
    RunningCutaneous() {
        SessionControl order;
        order.kind = ControlKind::kTrialStart;
        order.modality = Modality::kCF;
        session.send(now, 1, order);
        tick(milliseconds{0});
        for (int ms = 1; ms <= 10; ++ms) {
            feed(-1.2);
            tick(milliseconds{1});
        }
    }
    void feed(double force_N) {
        ForceFeedback feedback;
        feedback.force_total_N = force_N;
        slave.send(now, 1, feedback);
    }
    void tick(Duration later) {
        now += later;
        process.tick(now);
    }

    QueuePipe control, force, percept;
    ObedientActuator actuator;
    CutaneousProcess process{5, ramping(), {&control.b, &force.b, &percept.a}, actuator};
    OutboundFlow session{Role::kSession, 1, {&control.a}};
    OutboundFlow slave{Role::kSlaveSim, 2, {&force.a}};
    SessionTime now{};
};

TEST_F(RunningCutaneous, AfterAStallTheFingersStaySlackUntilTheNextForce) {
    ASSERT_EQ(actuator.pressed.force_N, 1.2);
    const int commands = actuator.commands;
    for (const Duration later : {milliseconds{102}, milliseconds{1}, milliseconds{1}}) {
        tick(later);
        EXPECT_EQ(actuator.pressed.force_N, 0);
    }
    EXPECT_EQ(actuator.commands, commands) << "not for an instant either";
    feed(-0.5);
    tick(milliseconds{1});
    EXPECT_EQ(actuator.pressed.force_N, 0.5);
}

TEST_F(RunningCutaneous, AtRestNoForceReachesTheFingersThatComesMeanwhile) {
    process.set_overrun(OverrunPolicy::kRest, 3);
    process.deadlines_missed(now, 3);
    const int commands = actuator.commands;
    for (int ms = 0; ms < 5; ++ms) {
        feed(-1.2);
        tick(milliseconds{1});
        EXPECT_EQ(actuator.pressed.force_N, 0);
        EXPECT_EQ(actuator.ticked_N, 0);
    }
    EXPECT_EQ(actuator.commands, commands);
    process.deadlines_missed(now, 0);
    tick(milliseconds{1});
    EXPECT_EQ(actuator.pressed.force_N, 0) << "until the next force";
    feed(-0.7);
    tick(milliseconds{1});
    EXPECT_EQ(actuator.pressed.force_N, 0.7);
    EXPECT_EQ(process.stale_record().trials(), 0U) << "nothing was stale";
}

}  // namespace
}  // namespace thimble
