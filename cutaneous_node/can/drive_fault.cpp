#include "cutaneous_node/can/drive_fault.hpp"

#include <fmt/format.h>

#include "cutaneous_node/can/canopen.hpp"
#include "cutaneous_node/can/cia402.hpp"

namespace thimble {
namespace {

std::string of_start(const DriveFault& f, const std::string& device, const std::string& bus) {
    switch (f.kind) {
        case DriveFaultKind::kNoBootUp:
            return fmt::format(
                "{}: no boot-up on {} after its reset; is it powered, wired, terminated, and is that its "
                "node id and bit rate?",
                device, bus);
        case DriveFaultKind::kNoAnswer:
            return fmt::format("{}: no answer to '{}'; check cable and termination of {}", device, f.step,
                               bus);
        case DriveFaultKind::kAborted:
            return fmt::format(
                "{}: refused '{}' with SDO abort {:#010x} ({}); does its firmware know CiA 402?", device,
                f.step, f.code, abort_text(f.code));
        case DriveFaultKind::kNotThatDrive:
            return fmt::format("{}: device type {:#010x} is no CiA 402 drive; check the node ids", device,
                               f.code);
        case DriveFaultKind::kNoMode:
            return fmt::format("{}: its modes {:#x} lack the one asked for; set [cutaneous.drives] mode",
                               device, f.code);
        case DriveFaultKind::kNoRatedTorque:
            return fmt::format("{}: rated torque (0x6076) is 0; set the motor's data in the drive", device);
        case DriveFaultKind::kStuck:
            return fmt::format(
                "{}: stays at '{}' at the step '{}'; look at its error (0x603F) and its power stage", device,
                to_string(state_of(static_cast<std::uint16_t>(f.code))), f.step);
        case DriveFaultKind::kNoTakeUp:
            return fmt::format(
                "{}: the cable does not get taut; is the device worn, the cable on its pulley, the sign "
                "(reversed) right?",
                device);
        default:
            return {};
    }
}

std::string of_bus(const DriveFault& f, const std::string& bus) {
    switch (f.kind) {
        case DriveFaultKind::kBusOff:
            return fmt::format(
                "{}: bus-off; check termination, bit rate and cables, then set the interface down and up",
                bus);
        case DriveFaultKind::kQueueFull:
            return fmt::format(
                "{}: frames cannot be sent, its queue is full; 'ip link set {} txqueuelen 100', or is it not "
                "connected?",
                bus, bus);
        default:
            return fmt::format("{}: the interface is gone or down; 'ip link set {} up', then start again",
                               bus, bus);
    }
}

}  // namespace

std::string describe(const DriveFault& f, const std::string& device, const std::string& bus) {
    switch (f.kind) {
        case DriveFaultKind::kHeartbeatLost:
            return fmt::format("{}: heartbeat lost; check its power and the cable of {}", device, bus);
        case DriveFaultKind::kDataLost:
            return fmt::format("{}: lives, but sends no process data; is {} overloaded (longer cycle_s)?",
                               device, bus);
        case DriveFaultKind::kDataLength:
            return fmt::format("{}: process data of {} bytes, not 8; has something else changed its mapping?",
                               device, f.code);
        case DriveFaultKind::kEmergency:
            return fmt::format("{}: EMCY {:#06x} ({}); remove the cause, then start again", device, f.code,
                               emergency_text(static_cast<std::uint16_t>(f.code)));
        case DriveFaultKind::kRebooted:
            return fmt::format(
                "{}: has restarted, or a second device has its node id; check the supply, then start again",
                device);
        case DriveFaultKind::kDuplicate:
            return fmt::format("{}: two devices have this node id; give one of them another", device);
        case DriveFaultKind::kLeftOperation:
            return fmt::format("{}: left operation, now '{}'; look at its error (0x603F), then start again",
                               device, to_string(state_of(static_cast<std::uint16_t>(f.code))));
        case DriveFaultKind::kSlack:
            return fmt::format(
                "{}: the cable is slack or torn, or the device came off; check it, then start again", device);
        case DriveFaultKind::kNoDevice:
            return fmt::format(
                "no device for a finger that this trial presses; name its drives in [cutaneous.drives], or "
                "choose another modality");
        case DriveFaultKind::kBusOff:
        case DriveFaultKind::kBusDown:
        case DriveFaultKind::kQueueFull:
            return of_bus(f, bus);
        default:
            return of_start(f, device, bus);
    }
}

}  // namespace thimble
