// thimble-cutaneous: the wearable fingertip device.
#include <memory>

#include "common/control/control_settings.hpp"
#include "common/runtime/node_program.hpp"
#include "common/runtime/node_report.hpp"
#include "cutaneous_node/cutaneous_process.hpp"
#include "cutaneous_node/open_actuator.hpp"

namespace {

using namespace thimble;

class Cutaneous final : public NodeInstance {
  public:
    Cutaneous(const CutaneousSettings& settings, const RuntimeSettings& runtime, Sockets& sockets,
              std::uint64_t instance)
        : open_(open_actuator(settings, runtime, sockets)),
          stale_(settings.stale),
          process_(instance, settings, sockets, *open_.actuator) {}

    NodeProcess& process() override { return process_; }
    void bring_up() override { open_.bring_up(); }
    void describe(nlohmann::ordered_json& report) const override {
        describe_stale(report, stale_, process_.stale_record());
        open_.describe(report);
    }

  private:
    OpenActuator open_;
    StalePolicy stale_;
    CutaneousProcess process_;
};

CutaneousSettings read_settings(const ConfigFile& file) {
    CutaneousSettings settings = read_cutaneous_settings(file.table("cutaneous"));
    settings.hand_share = read_control_settings(file).hand_share();
    return settings;
}

std::unique_ptr<NodeInstance> build(const ConfigFile& file, Sockets& sockets, std::uint64_t instance) {
    return std::make_unique<Cutaneous>(read_settings(file), read_runtime_settings(file), sockets, instance);
}

}  // namespace

int main(int argc, char** argv) {
    NodeProgram program;
    program.name = "thimble-cutaneous";
    program.description =
        "Presses the force of the needle on a finger: the index finger for a push, the thumb for a pull. In "
        "CF it is a finger of the hand at the handle, in CCF of the other hand. The device is simulated, a "
        "USB fingertip board, CAN motor drives, or WEART TouchDIVER ([cutaneous] device).";
    program.example = "thimble-cutaneous deploy/sessions/delay50.toml";
    program.tables = {"network", "runtime", "cutaneous", "control"};
    program.read = [](const ConfigFile& file) { read_settings(file); };
    program.build = build;
    return run_node_program(program, argc, argv);
}
