// The reactions of a node that is stopped, or late again and again.
#include <array>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/runtime/node_program.hpp"
#include "tests/unit/common/tiny_node.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

class StoppedNode : public NodeProcessTest {
  protected:
    StoppedNode() {
        process.join_stop_bus(line.b,
                              {&outside.a, &outside.a, &outside.a, &outside.a, &outside.a, &outside.a});
        start();
    }
    void say(const StopOrder& stop) {
        Encoder encoder;
        line.a.send(encoder.encode(Header{9, now, 1, 0, Role::kExperimenter}, stop));
    }

    QueuePipe line, outside;
};

TEST_F(StoppedNode, EndsItsTrialInTheStopsWordsAndBeginsNoneBeforeTheRelease) {
    say(StopOrder(5, StopKind::kStop, EndReason::kEmergencyStop, "a key"));
    order(ControlKind::kFixtureChange, 1);
    tick(milliseconds{20});
    EXPECT_EQ(process.said, Said{"end 1"}) << "and no order of the same tick is obeyed";
    const auto told = heartbeats();
    ASSERT_EQ(told.size(), 2U);
    EXPECT_EQ(std::get<Heartbeat>(told[0].body).state, NodeState::kFailed);
    EXPECT_EQ(std::get<Heartbeat>(told[0].body).reason, EndReason::kEmergencyStop);
    EXPECT_EQ(std::get<DeviceFault>(told[1].body).words(), "a key");
    order(ControlKind::kTrialStart, 2);
    tick(milliseconds{300});
    EXPECT_EQ(process.said, Said{"end 1"});
    EXPECT_EQ(std::get<Heartbeat>(heartbeats()[0].body).state, NodeState::kFailed);
    say(StopOrder(5, StopKind::kRelease, EndReason::kEmergencyStop, {}));
    order(ControlKind::kTrialStart, 3);
    tick(milliseconds{310});
    EXPECT_EQ(process.said, (Said{"end 1", "begin 3 CF"}));
}

TEST_F(StoppedNode, StopsTheOthersFromHere) {
    process.request = {EndReason::kSafetyStop, "the guard"};
    tick(milliseconds{20});
    EXPECT_EQ(process.said, Said{"end 1"});
    const auto decoded = decode(outside.b.receive());
    ASSERT_TRUE(decoded.message);
    EXPECT_EQ(std::get<StopOrder>(decoded.message->body).words(), "the guard");
    EXPECT_EQ(std::get<StopOrder>(decoded.message->body).reason, EndReason::kSafetyStop);
    EXPECT_EQ(process.next_wakeup(), now + kStopRepeat) << "it is said again before the next heartbeat";
}

TEST_F(StoppedNode, DeadlinesMissedInARow) {
    process.set_overrun(OverrunPolicy::kRest, 3);
    process.deadlines_missed(now, 2);
    tick(milliseconds{20});
    EXPECT_EQ(process.rests, 0);
    for (unsigned missed = 3; missed < 6; ++missed) process.deadlines_missed(now, missed);
    EXPECT_EQ(process.overruns(), 1U) << "one run of them";
    tick(milliseconds{21});
    tick(milliseconds{22});
    EXPECT_EQ(process.rests, 2) << "for as long as it is late";
    process.deadlines_missed(now, 0);
    tick(milliseconds{23});
    EXPECT_EQ(process.rests, 2);
    EXPECT_EQ(process.state(), NodeState::kRunning);
    process.set_overrun(OverrunPolicy::kStop, 3);
    process.deadlines_missed(now, 3);
    EXPECT_EQ(process.overruns(), 2U);
    EXPECT_EQ(process.state(), NodeState::kFailed);
    EXPECT_EQ(process.reason(), EndReason::kSafetyStop);
    EXPECT_EQ(process.stop_bus().words(), "visual missed 3 deadlines in a row");
}

// The program around a node. Each test forks: signals belong to a whole process.
// Ends the program with its first tick: 0 if everything was stopped by then.
class LooksForAStop final : public NodeProcess {
  public:
    explicit LooksForAStop(Channel& control) : NodeProcess(Role::kVisual, 42, control) {}

  protected:
    void begin_trial(SessionTime, const SessionControl&) override {}
    void end_trial(SessionTime) override {}
    void work(SessionTime) override { std::exit(stop_bus().stopped() ? 0 : 1); }
    SessionTime next_work() const override { return kNever; }
};

class StoppedWhileMadeReady final : public NodeInstance {
  public:
    NodeProcess& process() override { return process_; }
    void bring_up() override { std::raise(SIGQUIT); }

  private:
    QueuePipe steering_;
    LooksForAStop process_{steering_.b};
};

template <class Instance>
int run_node() {
    NodeProgram program;
    program.name = "test";
    program.tables = {"network", "runtime"};
    program.build = [](const ConfigFile&, Sockets&, std::uint64_t) { return std::make_unique<Instance>(); };
    std::string name = program.name;
    std::array<char*, 2> argv{name.data(), nullptr};
    return run_node_program(program, 1, argv.data());
}

TEST(NodeProgramDeathTest, AStopThatComesWhileDevicesAreMadeReadyHoldsBeforeTheFirstTick) {
    EXPECT_EXIT(run_node<StoppedWhileMadeReady>(), testing::ExitedWithCode(0), "");
}

// As a subject's window does.
class LosesItsScreen final : public NodeInstance {
  public:
    NodeProcess& process() override { return process_; }
    bool has_foreground() const override { return true; }
    void foreground(const std::function<bool()>&) override {
        std::raise(SIGTERM);
        throw Error(ExitCode::kRunFailed, "no screen");
    }

  private:
    QueuePipe steering_;
    TinyProcess process_{steering_.b};
};

TEST(NodeProgramDeathTest, AnErrorOfTheForegroundIsSaidOnce) {
    EXPECT_EXIT(std::exit(run_node<LosesItsScreen>()), testing::ExitedWithCode(1),
                AllOf(HasSubstr("error: no screen"), Not(ContainsRegex("no screen.*no screen"))));
}

}  // namespace
}  // namespace thimble
