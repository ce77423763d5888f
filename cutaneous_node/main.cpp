// thimble-cutaneous: the wearable fingertip device.
#include <memory>

#include "common/control/control_settings.hpp"
#include "common/runtime/hid/hid_thread.hpp"
#include "common/runtime/node_program.hpp"
#include "common/runtime/node_report.hpp"
#include "common/runtime/wall_clock.hpp"
#include "cutaneous_node/board/board_actuator.hpp"
#include "cutaneous_node/can/bus_from_settings.hpp"
#include "cutaneous_node/cutaneous_process.hpp"
#include "cutaneous_node/drive_run.hpp"
#include "cutaneous_node/simulated_actuator.hpp"

namespace {

using namespace thimble;

constexpr Duration kFirstWord = std::chrono::seconds{1};

// A fingertip board, and the thread that talks to it.
struct Board {
    Board(const CutaneousSettings& settings, const RuntimeSettings& runtime)
        : actuator(settings.board, settings.force_limit_N), thread(actuator, runtime) {}

    // The first trial may begin as soon as this node is ready: a board that is there has spoken by then.
    void await_first_word() const {
        const SessionTime end = wall_now() + kFirstWord;
        while (!actuator.fault().empty() && wall_now() < end) wall_sleep(std::chrono::milliseconds{5});
    }

    BoardActuator actuator;
    HidThread thread;
};

CutaneousProcess::Channels open_channels(Sockets& sockets) {
    return {sockets.between(Port::kCutaneousControl, Port::kSessionCutaneous),
            sockets.inlet(Port::kCutaneousForce, Role::kNetem),
            sockets.outlet(Port::kMasterPerceptCutaneous)};
}

class UndrivenCutaneous final : public NodeInstance {
  public:
    UndrivenCutaneous(const CutaneousSettings& settings, const RuntimeSettings& runtime, Sockets& sockets,
                      std::uint64_t instance)
        : simulated_(settings),
          board_(settings.device == FingertipDevice::kBoard ? std::make_unique<Board>(settings, runtime)
                                                            : nullptr),
          stale_(settings.stale),
          process_(instance, settings, open_channels(sockets), actuator()) {
        process_.join_stop_line(*sockets.inlet_for_all(Port::kCutaneousStop), sockets.stop_outlets());
    }

    NodeProcess& process() override { return process_; }
    void bring_up() override {
        if (board_) board_->await_first_word();
    }
    void describe(nlohmann::ordered_json& report) const override {
        describe_stale(report, stale_, process_.stale_record());
        if (board_) report["board"] = {{"bad_reports", board_->actuator.bad_reports()}};
    }

  private:
    FingertipActuator& actuator() {
        if (board_) return board_->actuator;
        return simulated_;
    }

    SimulatedActuator simulated_;
    std::unique_ptr<Board> board_;
    StalePolicy stale_;
    CutaneousProcess process_;
};

class DrivenCutaneous final : public NodeInstance {
  public:
    DrivenCutaneous(const CutaneousSettings& settings, Sockets& sockets, std::uint64_t instance)
        : bus_(open_bus(settings.drives, sockets)),
          actuator_(settings.drives, settings.force_limit_N, *bus_),
          stale_(settings.stale),
          process_(instance, settings, open_channels(sockets), actuator_) {
        process_.join_stop_line(*sockets.inlet_for_all(Port::kCutaneousStop), sockets.stop_outlets());
    }
    ~DrivenCutaneous() override { actuator_.stop(); }

    NodeProcess& process() override { return process_; }
    void bring_up() override { bring_up_drives(actuator_); }
    void describe(nlohmann::ordered_json& report) const override {
        describe_stale(report, stale_, process_.stale_record());
        report["drives"] = describe_drives(actuator_);
    }

  private:
    std::unique_ptr<CanBus> bus_;
    DriveActuator actuator_;
    StalePolicy stale_;
    CutaneousProcess process_;
};

std::unique_ptr<NodeInstance> build(const ConfigFile& file, Sockets& sockets, std::uint64_t instance) {
    CutaneousSettings settings = read_cutaneous_settings(file.table("cutaneous"));
    settings.hand_share = read_control_settings(file.table("control")).hand_share();
    if (settings.device == FingertipDevice::kDrives) {
        return std::make_unique<DrivenCutaneous>(settings, sockets, instance);
    }
    return std::make_unique<UndrivenCutaneous>(settings, read_runtime_settings(file), sockets, instance);
}

}  // namespace

int main(int argc, char** argv) {
    NodeProgram program;
    program.name = "thimble-cutaneous";
    program.description =
        "Presses the force that the needle feels on a finger: the index for a push, the thumb for a pull, of "
        "the hand "
        "on the handle (CF) or of the other one (CCF). The device is simulated, a fingertip board on USB, or "
        "drives on "
        "a CAN bus ([cutaneous] device).";
    program.example = "thimble-cutaneous --config deploy/sessions/delay50.toml";
    program.tables = {"network", "runtime", "cutaneous", "control"};
    program.build = build;
    return run_node_program(program, argc, argv);
}
