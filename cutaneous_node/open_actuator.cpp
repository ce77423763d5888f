#include "cutaneous_node/open_actuator.hpp"

#include <boost/core/noncopyable.hpp>
#include <nlohmann/json.hpp>

#include "common/runtime/hid/hid_thread.hpp"
#include "common/runtime/protection.hpp"
#include "common/runtime/tcp_client.hpp"
#include "common/runtime/wall_clock.hpp"
#include "cutaneous_node/board/board_actuator.hpp"
#include "cutaneous_node/drive_run.hpp"
#include "cutaneous_node/simulated_actuator.hpp"
#include "cutaneous_node/touchdiver/touchdiver_actuator.hpp"

namespace thimble {
namespace {

constexpr Duration kFirstWord = std::chrono::seconds{1};

// Waits for the board's first status: the first trial may begin once this node is ready.
void await_first_status(const BoardActuator& board) {
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
            [&actuator] { await_first_status(actuator); },
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

constexpr Duration kMiddlewareStarts = std::chrono::seconds{5};  // a device that it runs
constexpr Duration kLastWords = std::chrono::milliseconds{100};

// The middleware answers within moments if it is there, and starts its devices within seconds.
void await_middleware(TouchDiverActuator& actuator) {
    const SessionTime begin = wall_now();
    const auto goes_on = [&] {
        const Duration limit = actuator.connected() ? kMiddlewareStarts : kFirstWord;
        return !actuator.fault().empty() && wall_now() - begin < limit && !stop_requested();
    };
    do {
        actuator.tick(wall_now());
        wall_sleep(std::chrono::milliseconds{1});
    } while (goes_on());
}

// Reads on meanwhile: closing a socket with unread bytes may lose the last messages.
void stop_middleware(TouchDiverActuator& actuator) {
    actuator.stop();
    for (const SessionTime end = wall_now() + kLastWords; actuator.connected() && wall_now() < end;) {
        wall_sleep(std::chrono::milliseconds{2});
        actuator.tick(wall_now());
    }
}

OpenActuator open_touchdiver(const CutaneousSettings& settings, const Sockets& sockets) {
    struct TouchDiver : boost::noncopyable {
        TcpClient client;
        TouchDiverActuator actuator;
        explicit TouchDiver(const CutaneousSettings& s)
            : client({s.touchdiver.host, s.touchdiver.port}, "check [cutaneous.touchdiver] host"),
              actuator(s.touchdiver, s.force_limit_N, client) {}
        ~TouchDiver() { stop_middleware(actuator); }
    };
    require_protection_of_device(sockets.settings().security, settings.touchdiver.host);
    const auto device = std::make_shared<TouchDiver>(settings);
    TouchDiverActuator& actuator = device->actuator;
    return {
        {device, &actuator},
        [&actuator] { await_middleware(actuator); },
        [&actuator](auto& report) {
            report["touchdiver"] = {{"forces", actuator.forces()}, {"bad_messages", actuator.bad_messages()}};
        }};
}

}  // namespace

OpenActuator open_actuator(const CutaneousSettings& settings, const RuntimeSettings& runtime,
                           Sockets& sockets) {
    switch (settings.device) {
        case FingertipDevice::kBoard:
            return open_board(settings, runtime);
        case FingertipDevice::kDrives:
            return open_drives(settings, sockets);
        case FingertipDevice::kTouchDiver:
            return open_touchdiver(settings, sockets);
        case FingertipDevice::kSimulated:
            break;
    }
    OpenActuator open;
    open.actuator = std::make_shared<SimulatedActuator>(settings);
    return open;
}

}  // namespace thimble
