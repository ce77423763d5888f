#include "cutaneous_node/can/drive_fault.hpp"

#include <array>

#include <fmt/format.h>

#include "cutaneous_node/can/canopen.hpp"
#include "cutaneous_node/can/cia402.hpp"

namespace thimble {
namespace {

// By DriveFaultKind. {means}: the code in words.
constexpr std::array<const char*, 20> kFaultTexts{
    "{device}: no boot-up message on {bus} after its reset; check its power, wiring and termination, its "
    "node id and the bit rate",
    "{device}: no answer to '{step}'; check cable and termination of {bus}",
    "{device}: rejected '{step}' with SDO abort {code:#010x} ({means}); does its firmware support CiA 402?",
    "{device}: device type {code:#010x} is not a CiA 402 drive; check the node ids",
    "{device}: its modes {code:#x} do not include the requested one; set [cutaneous.drives] mode",
    "{device}: rated torque (0x6076) is 0; set the motor's data in the drive",
    "{device}: stays in state '{means}' at the step '{step}'; look at its error (0x603F) and its power stage",
    "{device}: the cable does not become taut; is the device on the finger, the cable on its pulley, the "
    "direction (reversed) right?",
    "{device}: its heartbeat is lost; check its power and the cable of {bus}",
    "{device}: it runs, but sends no process data; is {bus} overloaded (use a longer cycle_s)?",
    "{device}: process data of {code} bytes, not 8; has another program changed its mapping?",
    "{device}: EMCY {code:#06x} ({means}); remove the cause, then start again",
    "{device}: has restarted, or a second device has its node id; check the supply, then start again",
    "{device}: two devices have this node id; give one of them another",
    "{device}: left normal operation, its state is '{means}'; look at its error (0x603F), then start again",
    "{device}: the cable is slack or broken, or the device came off the finger; check it, then start again",
    "there is no device for a finger that this trial presses; name its drives in [cutaneous.drives], or "
    "choose another modality",
    "{bus}: bus-off; check termination, bit rate and cables, then set the interface down and up",
    "{bus}: the interface is gone or down; 'ip link set {bus} up', then start again",
    "{bus}: cannot send, its queue is full; is the bus connected? Else 'ip link set {bus} txqueuelen 100'"};

const char* meaning(const DriveFault& f) {
    switch (f.kind) {
        case DriveFaultKind::kAborted:
            return abort_text(f.code);
        case DriveFaultKind::kEmergency:
            return emergency_text(static_cast<std::uint16_t>(f.code));
        default:
            return to_string(state_of(static_cast<std::uint16_t>(f.code)));
    }
}

}  // namespace

std::string describe(const DriveFault& f, const std::string& device, const std::string& bus) {
    return fmt::format(fmt::runtime(kFaultTexts.at(static_cast<std::size_t>(f.kind))),
                       fmt::arg("device", device), fmt::arg("bus", bus), fmt::arg("step", f.step),
                       fmt::arg("code", f.code), fmt::arg("means", meaning(f)));
}

}  // namespace thimble
