// thimble-slave-sim: the needle in simulated tissue, or moved by a robot, before a virtual fixture.
#include <memory>

#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/runtime/node_program.hpp"
#include "common/runtime/node_report.hpp"
#include "common/runtime/protection.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/stale_policy.hpp"
#ifdef THIMBLE_ROS2_SLAVE
#include "slave_sim/ros2_needle.hpp"
#else
#include "slave_sim/remote_needle.hpp"
#endif
#include "slave_sim/slave_process.hpp"

namespace {

using namespace thimble;

SlaveSettings timed(SlaveSettings settings) {
    settings.control.control.clock = wall_now;
    return settings;
}

#ifdef THIMBLE_ROS2_SLAVE
constexpr const char* kName = "thimble-ros2-slave";
// A robot obeys each needle command, so an unprotected network could move it.
std::unique_ptr<RemoteNeedle> make_robot(const ConfigFile& file, const NetworkSettings& network) {
    const SlaveSettings settings = read_slave_settings(file);
    if (settings.device != SlaveDevice::kRos2)
        throw Error(ExitCode::kUsage,
                    "{} works with [slave_sim] device = \"ros2\" only: use thimble-slave-sim", kName);
    require_protection_of_handle(network);
    require_protection_of_dds(read_security_settings(file), "slave_sim.ros2", settings.ros2.interface);
    return std::make_unique<Ros2Needle>(settings.ros2, settings.robot);
}
#else
constexpr const char* kName = "thimble-slave-sim";
std::unique_ptr<RemoteNeedle> make_robot(const ConfigFile& file, const NetworkSettings& /*network*/) {
    if (read_slave_settings(file).device == SlaveDevice::kSimulated) return nullptr;
    throw Error(ExitCode::kUsage,
                "[slave_sim] device = \"ros2\" needs thimble-ros2-slave instead of {}; 'thimble run' starts "
                "it by itself",
                kName);
}
#endif

class Slave final : public NodeInstance {
  public:
    Slave(const ConfigFile& file, Sockets& sockets, std::uint64_t instance)
        : robot_(make_robot(file, sockets.settings())),
          process_(instance, timed(read_slave_settings(file)), sockets, robot_.get()),
          stale_after_(read_slave_settings(file).stale_after) {}

    NodeProcess& process() override { return process_; }
    void bring_up() override {
        if (robot_ == nullptr) return;
        spdlog::info("robot: {}", robot_->name());
        await_user([this] { return robot_->awaits(); }, kRos2DriverLimit);
    }
    void describe(nlohmann::ordered_json& report) const override {
        describe_stale(report, {StaleMode::kHold, stale_after_}, process_.stale_record());
        if (process_.plugin() != nullptr) describe_plugin(report, *process_.plugin());
        if (robot_ != nullptr) robot_->describe(report);
    }

  private:
    std::unique_ptr<RemoteNeedle> robot_;
    SlaveProcess process_;
    Duration stale_after_;
};

}  // namespace

int main(int argc, char** argv) {
    NodeProgram program;
    program.name = kName;
    program.description =
        "The remote side: moves the needle in a simulated tissue with a virtual fixture, and answers each "
        "needle command with the force. thimble-ros2-slave moves a robot's needle instead (docs/ros2.md). "
        "Gives the beep after unbroken contact with the fixture for trial.contact_hold_s (5 s).";
    program.example = std::string(kName) + " deploy/sessions/delay50.toml";
    program.tables = {"network", "runtime", "tissue", "fixture", "slave_sim", "control", "codec"};
    program.read = [](const ConfigFile& file) { read_slave_settings(file); };
    program.build = [](const ConfigFile& file, Sockets& sockets, std::uint64_t instance) {
        return std::make_unique<Slave>(file, sockets, instance);
    };
    return run_node_program(program, argc, argv);
}
