// The part of CANopen (CiA 301) that a master of a few drives needs, as frames: network management, heartbeat, SYNC, EMCY and
// expedited SDO. docs/can.md has the bytes.
#pragma once

#include <cstdint>
#include <optional>

#include "cutaneous_node/can/can_bus.hpp"

namespace thimble {

enum class CobBase : std::uint32_t {  // + node id, except the first two
    kNetwork = 0x000,
    kSync = 0x080,
    kEmergency = 0x080,
    kTransmit1 = 0x180,  // TPDO1: drive to master
    kReceive1 = 0x200,   // RPDO1: master to drive
    kSdoReply = 0x580,
    kSdoRequest = 0x600,
    kHeartbeat = 0x700,
};
constexpr std::uint32_t cob(CobBase base, std::uint8_t node = 0) {
    return static_cast<std::uint32_t>(base) + node;
}
// Of an 11-bit identifier: which service, whose.
constexpr std::uint32_t cob_base(std::uint32_t id) { return id & 0x780U; }
constexpr std::uint8_t cob_node(std::uint32_t id) { return static_cast<std::uint8_t>(id & 0x7fU); }

enum class NetworkCommand : std::uint8_t {
    kStart = 1,
    kStop = 2,
    kPreOperational = 0x80,
    kResetNode = 0x81,
    kResetCommunication = 0x82,
};
enum class NetworkState : std::uint8_t { kBootUp = 0, kStopped = 4, kOperational = 5, kPreOperational = 127 };

// Node 0: all of them.
CanFrame network_frame(NetworkCommand command, std::uint8_t node);
CanFrame sync_frame();
CanFrame heartbeat_frame(std::uint8_t node, NetworkState state);

struct Emergency {
    std::uint16_t code = 0;  // 0: the error is over
    std::uint8_t error_register = 0;
};
CanFrame emergency_frame(std::uint8_t node, const Emergency& emergency);
std::optional<Emergency> read_emergency(const CanFrame& frame);
const char* emergency_text(std::uint16_t code);

// An entry of the object dictionary.
struct ObjectKey {
    std::uint16_t index = 0;
    std::uint8_t sub = 0;
    bool operator==(const ObjectKey&) const = default;
    bool operator<(const ObjectKey& other) const {
        return index != other.index ? index < other.index : sub < other.sub;
    }
};

enum class SdoKind : std::uint8_t { kRead, kWrite, kAbort };
// A request (client to server), or what is answered to it.
struct Sdo {
    SdoKind kind = SdoKind::kRead;
    ObjectKey key;
    std::uint32_t value = 0;  // of an abort: its code
    std::uint8_t bytes = 4;   // of the value
};
CanFrame sdo_request(std::uint8_t node, const Sdo& request);
CanFrame sdo_reply(std::uint8_t node, const Sdo& reply);
// Nothing: 8 bytes they are not, or no expedited transfer.
std::optional<Sdo> read_sdo_request(const CanFrame& frame);
std::optional<Sdo> read_sdo_reply(const CanFrame& frame);

enum class SdoAbort : std::uint32_t {
    kTimeout = 0x05040000,
    kUnknownCommand = 0x05040001,
    kReadOnly = 0x06010002,
    kNoObject = 0x06020000,
    kCannotMap = 0x06040041,
    kMapTooLong = 0x06040042,
    kLength = 0x06070010,
    kNoSubIndex = 0x06090011,
    kValue = 0x06090030,
    kDeviceState = 0x08000022,
};
const char* abort_text(std::uint32_t code);

}  // namespace thimble
