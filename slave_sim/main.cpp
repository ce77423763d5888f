// thimble-slave-sim: the needle in simulated tissue before a virtual fixture.
#include "common/runtime/node_program.hpp"
#include "common/runtime/node_report.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/stale_policy.hpp"
#include "slave_sim/slave_process.hpp"

namespace {

using namespace thimble;

SlaveSettings timed(SlaveSettings settings) {
    settings.control.control.clock = wall_now;
    return settings;
}

class Slave final : public NodeInstance {
  public:
    Slave(const ConfigFile& file, Sockets& sockets, std::uint64_t instance)
        : process_(instance, timed(read_slave_settings(file)), sockets),
          stale_after_(read_slave_settings(file).stale_after) {}

    NodeProcess& process() override { return process_; }
    void describe(nlohmann::ordered_json& report) const override {
        describe_stale(report, {StaleMode::kHold, stale_after_}, process_.stale_record());
        if (process_.plugin() != nullptr) describe_plugin(report, *process_.plugin());
    }

  private:
    SlaveProcess process_;
    Duration stale_after_;
};

}  // namespace

int main(int argc, char** argv) {
    NodeProgram program;
    program.name = "thimble-slave-sim";
    program.description =
        "The remote side, simulated: tissue, virtual fixture and proxy. Answers each needle command the "
        "moment it "
        "arrives, and gives the beep after trial.contact_hold_s (5 s) of unbroken contact with the fixture.";
    program.example = "thimble-slave-sim deploy/sessions/delay50.toml";
    program.tables = {"network", "runtime", "tissue", "fixture", "slave_sim", "control", "codec"};
    program.read = [](const ConfigFile& file) { read_slave_settings(file); };
    program.build = [](const ConfigFile& file, Sockets& sockets, std::uint64_t instance) {
        return std::make_unique<Slave>(file, sockets, instance);
    };
    return run_node_program(program, argc, argv);
}
