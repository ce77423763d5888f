// The handle while the master is to keep its outputs at rest, and afterwards.
#include <gtest/gtest.h>

#include "common/queue_channel.hpp"
#include "master/master_process.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

class NotingHandle final : public HapticDevice {
  public:
    HandleSample read(SessionTime) override { return {0, commanded_N}; }
    void command_force(SessionTime, double force_hand_N) override {
        commanded_N = force_hand_N;
        largest_N = std::max(largest_N, force_hand_N);
    }
    void enable_force(SessionTime, bool) override {}
    bool take_stop(SessionTime) override { return false; }
    SessionTime next_look() const override { return kNever; }
    std::string_view fault() const override { return {}; }

    double commanded_N = 0;
    double largest_N = 0;  // since it was set
};

class NobodyAtTheHandle final : public OperatorPort {
  public:
    void start_trial(SessionTime, const OperatorTask&) override {}
    void perceive(SessionTime, const Percept&) override {}
    bool finished() const override { return false; }
};

class RestingMaster : public testing::Test {
  protected:
    RestingMaster() {
        SessionControl order;
        order.kind = ControlKind::kTrialStart;
        order.modality = Modality::kHF;
        session.send(now, 1, order);
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
        ForceFeedback feedback;
        feedback.force_total_N = -5;
        feedback.echo_time = now;
        slave.send(now, 1, feedback);
        process.tick(now);
    }

    QueuePipe control, needle, force, skin, eyes;
    NotingHandle handle;
    NobodyAtTheHandle nobody;
    MasterProcess process{5, settings(), {&control.b, &needle.a, &force.b, &skin.b, &eyes.b}, handle, nobody};
    OutboundFlow session{Role::kSession, 1, {&control.a}};
    OutboundFlow slave{Role::kSlaveSim, 2, {&force.a}};
    SessionTime now{milliseconds{10}};
};

TEST_F(RestingMaster, NoForceReachesTheHandleAndAfterwardsItGrowsFromZero) {
    for (int ms = 0; ms < 8; ++ms) tick();
    ASSERT_EQ(handle.commanded_N, 5);
    process.set_overrun(OverrunPolicy::kRest, 3);
    process.deadlines_missed(now, 3);
    handle.largest_N = 0;
    for (int ms = 0; ms < 5; ++ms) {
        tick();
        EXPECT_EQ(handle.commanded_N, 0);
    }
    EXPECT_EQ(handle.largest_N, 0) << "not for an instant either";
    process.deadlines_missed(now, 0);
    for (int ms = 1; ms <= 4; ++ms) {
        tick();
        EXPECT_DOUBLE_EQ(handle.commanded_N, ms);
    }
}

}  // namespace
}  // namespace thimble
