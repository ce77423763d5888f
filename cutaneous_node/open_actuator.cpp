#include "cutaneous_node/open_actuator.hpp"

#include <boost/core/noncopyable.hpp>
#include <nlohmann/json.hpp>

#include "common/runtime/hid/hid_thread.hpp"
#include "common/runtime/wall_clock.hpp"
#include "cutaneous_node/board/board_actuator.hpp"
#include "cutaneous_node/drive_run.hpp"
#include "cutaneous_node/simulated_actuator.hpp"

namespace thimble {
namespace {

constexpr Duration kFirstWord = std::chrono::seconds{1};

// The first trial may begin as soon as this node is ready: a board that is there has spoken by then.
void await_first_word(const BoardActuator& board) {
    const SessionTime end = wall_now() + kFirstWord;
    while (!board.fault().empty() && wall_now() < end) wall_sleep(std::chrono::milliseconds{5});
}

// A fingertip board, and the thread that talks to it.
OpenActuator open_board(const CutaneousSettings& settings, const RuntimeSettings& runtime) {
    struct Board {
        BoardActuator actuator;
        HidThread thread;
        Board(const CutaneousSettings& s, const RuntimeSettings& r)
            : actuator(s.board, s.force_limit_N), thread(actuator, r) {}
    };
    const auto board = std::make_shared<Board>(settings, runtime);
    BoardActuator& actuator = board->actuator;
    return {{board, &actuator},
            [&actuator] { await_first_word(actuator); },
            [&actuator](auto& report) {
                report["board"] = {{"bad_reports", actuator.bad_reports()}};
            }};
}

OpenActuator open_drives(const CutaneousSettings& settings, Sockets& sockets) {
    struct Drives : boost::noncopyable {
        std::unique_ptr<CanBus> bus;
        DriveActuator actuator;
        Drives(const CutaneousSettings& s, Sockets& sockets)
            : bus(open_bus(s.drives, sockets)), actuator(s.drives, s.force_limit_N, *bus) {}
        ~Drives() { actuator.stop(); }
    };
    const auto drives = std::make_shared<Drives>(settings, sockets);
    DriveActuator& actuator = drives->actuator;
    return {{drives, &actuator},
            [&actuator] { bring_up_drives(actuator); },
            [&actuator](auto& report) { report["drives"] = describe_drives(actuator); }};
}

}  // namespace

OpenActuator open_actuator(const CutaneousSettings& settings, const RuntimeSettings& runtime,
                           Sockets& sockets) {
    switch (settings.device) {
        case FingertipDevice::kBoard:
            return open_board(settings, runtime);
        case FingertipDevice::kDrives:
            return open_drives(settings, sockets);
        case FingertipDevice::kSimulated:
            break;
    }
    OpenActuator open;
    open.actuator = std::make_shared<SimulatedActuator>(settings);
    return open;
}

}  // namespace thimble
