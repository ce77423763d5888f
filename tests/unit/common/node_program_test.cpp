// The program around a node. Each test forks: signals belong to a whole process.
#include "common/runtime/node_program.hpp"

#include <array>
#include <csignal>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "common/queue_channel.hpp"

namespace thimble {
namespace {

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

TEST(NodeProgramDeathTest, AStopThatComesWhileDevicesAreMadeReadyHoldsBeforeTheFirstTick) {
    NodeProgram program;
    program.name = "test";
    program.tables = {"network", "runtime"};
    program.build = [](const ConfigFile&, Sockets&, std::uint64_t) {
        return std::make_unique<StoppedWhileMadeReady>();
    };
    std::string name = program.name;
    std::array<char*, 2> argv{name.data(), nullptr};
    EXPECT_EXIT(run_node_program(program, 1, argv.data()), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace thimble
