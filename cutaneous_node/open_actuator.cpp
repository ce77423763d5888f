#include "cutaneous_node/open_actuator.hpp"

#include <nlohmann/json.hpp>

#include "common/runtime/hid/hid_thread.hpp"
#include "common/runtime/wall_clock.hpp"
#include "cutaneous_node/board/board_actuator.hpp"
#include "cutaneous_node/can/bus_from_settings.hpp"
#include "cutaneous_node/drive_run.hpp"
#include "cutaneous_node/simulated_actuator.hpp"

namespace thimble {
namespace {

constexpr Duration kFirstWord = std::chrono::seconds{1};

class OpenSimulated final : public OpenActuator {
  public:
    explicit OpenSimulated(const CutaneousSettings& settings) : actuator_(settings) {}
    FingertipActuator& actuator() override { return actuator_; }
    void bring_up() override {}
    void describe(nlohmann::ordered_json& /*report*/) const override {}

  private:
    SimulatedActuator actuator_;
};

// A fingertip board, and the thread that talks to it.
class OpenBoard final : public OpenActuator {
  public:
    OpenBoard(const CutaneousSettings& settings, const RuntimeSettings& runtime)
        : actuator_(settings.board, settings.force_limit_N), thread_(actuator_, runtime) {}

    FingertipActuator& actuator() override { return actuator_; }
    // The first trial may begin as soon as this node is ready: a board that is there has spoken by then.
    void bring_up() override {
        const SessionTime end = wall_now() + kFirstWord;
        while (!actuator_.fault().empty() && wall_now() < end) wall_sleep(std::chrono::milliseconds{5});
    }
    void describe(nlohmann::ordered_json& report) const override {
        report["board"] = {{"bad_reports", actuator_.bad_reports()}};
    }

  private:
    BoardActuator actuator_;
    HidThread thread_;
};

class OpenDrives final : public OpenActuator {
  public:
    OpenDrives(const CutaneousSettings& settings, Sockets& sockets)
        : bus_(open_bus(settings.drives, sockets)),
          actuator_(settings.drives, settings.force_limit_N, *bus_) {}
    ~OpenDrives() override { actuator_.stop(); }

    FingertipActuator& actuator() override { return actuator_; }
    void bring_up() override { bring_up_drives(actuator_); }
    void describe(nlohmann::ordered_json& report) const override {
        report["drives"] = describe_drives(actuator_);
    }

  private:
    std::unique_ptr<CanBus> bus_;
    DriveActuator actuator_;
};

}  // namespace

std::unique_ptr<OpenActuator> open_actuator(const CutaneousSettings& settings, const RuntimeSettings& runtime,
                                            Sockets& sockets) {
    switch (settings.device) {
        case FingertipDevice::kBoard:
            return std::make_unique<OpenBoard>(settings, runtime);
        case FingertipDevice::kDrives:
            return std::make_unique<OpenDrives>(settings, sockets);
        case FingertipDevice::kSimulated:
            break;
    }
    return std::make_unique<OpenSimulated>(settings);
}

}  // namespace thimble
