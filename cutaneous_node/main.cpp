// thimble-cutaneous: the wearable fingertip device.
#include "common/runtime/node_program.hpp"
#include "cutaneous_node/cutaneous_process.hpp"
#include "cutaneous_node/simulated_actuator.hpp"

namespace {

using namespace thimble;

class Cutaneous final : public NodeInstance {
  public:
    Cutaneous(const ConfigFile& file, Sockets& sockets, std::uint64_t instance)
        : settings_(read_cutaneous_settings(file.table("cutaneous"))),
          actuator_(settings_),
          process_(instance, settings_,
                   {sockets.between(Port::kCutaneousControl, Port::kSessionCutaneous),
                    sockets.inlet(Port::kCutaneousForce, Role::kNetem),
                    sockets.outlet(Port::kMasterPerceptCutaneous)},
                   actuator_) {}

    NodeProcess& process() override { return process_; }

  private:
    CutaneousSettings settings_;
    SimulatedActuator actuator_;
    CutaneousProcess process_;
};

}  // namespace

int main(int argc, char** argv) {
    NodeProgram program;
    program.name = "thimble-cutaneous";
    program.description =
        "Presses the force that the needle feels on a finger: the index for a push, the thumb for a pull, of "
        "the hand "
        "on the handle (CF) or of the other one (CCF). The actuator is simulated.";
    program.example = "thimble-cutaneous --config deploy/sessions/delay50.toml";
    program.tables = {"network", "runtime", "cutaneous"};
    program.build = [](const ConfigFile& file, Sockets& sockets, std::uint64_t instance) {
        return std::make_unique<Cutaneous>(file, sockets, instance);
    };
    return run_node_program(program, argc, argv);
}
