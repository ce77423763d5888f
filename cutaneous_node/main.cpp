// thimble-cutaneous: the wearable fingertip device.
#include <memory>

#include "common/runtime/hid/hid_thread.hpp"
#include "common/runtime/node_program.hpp"
#include "common/runtime/wall_clock.hpp"
#include "cutaneous_node/board/board_actuator.hpp"
#include "cutaneous_node/cutaneous_process.hpp"
#include "cutaneous_node/simulated_actuator.hpp"

namespace {

using namespace thimble;

constexpr Duration kFirstWord = std::chrono::seconds{1};

// A fingertip board, and the thread that talks to it.
struct Board {
    Board(const CutaneousSettings& settings, const RuntimeSettings& runtime)
        : actuator(settings.board, settings.force_limit_N), thread(actuator, runtime) {
        // The first trial may begin as soon as this node is ready: a board that is there has spoken by then.
        for (const SessionTime end = wall_now() + kFirstWord;
             !actuator.trouble().empty() && wall_now() < end;)
            wall_sleep(std::chrono::milliseconds{5});
    }
    BoardActuator actuator;
    HidThread thread;
};

class Cutaneous final : public NodeInstance {
  public:
    Cutaneous(const ConfigFile& file, Sockets& sockets, std::uint64_t instance)
        : settings_(read_cutaneous_settings(file.table("cutaneous"))),
          simulated_(settings_),
          board_(settings_.device == FingertipDevice::kBoard
                     ? std::make_unique<Board>(settings_, read_runtime_settings(file))
                     : nullptr),
          process_(instance, settings_,
                   {sockets.between(Port::kCutaneousControl, Port::kSessionCutaneous),
                    sockets.inlet(Port::kCutaneousForce, Role::kNetem),
                    sockets.outlet(Port::kMasterPerceptCutaneous)},
                   actuator()) {}

    NodeProcess& process() override { return process_; }
    void describe(nlohmann::ordered_json& report) const override {
        if (board_) report["board"] = {{"bad_reports", board_->actuator.bad_reports()}};
    }

  private:
    FingertipActuator& actuator() {
        if (board_) return board_->actuator;
        return simulated_;
    }

    CutaneousSettings settings_;
    SimulatedActuator simulated_;
    std::unique_ptr<Board> board_;
    CutaneousProcess process_;
};

}  // namespace

int main(int argc, char** argv) {
    NodeProgram program;
    program.name = "thimble-cutaneous";
    program.description =
        "Presses the force that the needle feels on a finger: the index for a push, the thumb for a pull, of "
        "the hand "
        "on the handle (CF) or of the other one (CCF). The device is simulated, or a fingertip board on USB.";
    program.example = "thimble-cutaneous --config deploy/sessions/delay50.toml";
    program.tables = {"network", "runtime", "cutaneous"};
    program.build = [](const ConfigFile& file, Sockets& sockets, std::uint64_t instance) {
        return std::make_unique<Cutaneous>(file, sockets, instance);
    };
    return run_node_program(program, argc, argv);
}
