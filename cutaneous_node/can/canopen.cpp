#include "cutaneous_node/can/canopen.hpp"

#include <array>
#include <utility>

namespace thimble {
namespace {

CanFrame frame_of(std::uint32_t id, std::uint8_t length) {
    CanFrame frame;
    frame.id = id;
    frame.length = length;
    return frame;
}

// Of the command byte: expedited, size given, and by how much the value falls short of four bytes.
constexpr std::uint8_t kExpedited = 0x03;
std::uint8_t size_bits(std::uint8_t bytes) {
    return static_cast<std::uint8_t>((4U - bytes) << 2U | kExpedited);
}

CanFrame sdo_frame(std::uint32_t id, std::uint8_t command, const Sdo& sdo, std::uint32_t value) {
    CanFrame frame = frame_of(id, 8);
    frame.data[0] = command;
    store(frame, 1, 2, sdo.key.index);
    frame.data[3] = sdo.key.sub;
    store(frame, 4, 4, value);
    return frame;
}

Sdo sdo_of(const CanFrame& frame, SdoKind kind) {
    return {kind, {static_cast<std::uint16_t>(load(frame, 1, 2)), frame.data[3]}, load(frame, 4, 4), 4};
}

// The value of an expedited transfer; one without a size counts as four bytes.
std::optional<Sdo> with_value(const CanFrame& frame, SdoKind kind) {
    if ((frame.data[0] & 0x02) == 0) return std::nullopt;  // segmented
    Sdo sdo = sdo_of(frame, kind);
    if ((frame.data[0] & 0x01) != 0) sdo.bytes = static_cast<std::uint8_t>(4U - (frame.data[0] >> 2U & 3U));
    sdo.value = load(frame, 4, sdo.bytes);
    return sdo;
}

}  // namespace

CanFrame network_frame(NetworkCommand command, std::uint8_t node) {
    CanFrame frame = frame_of(cob(CobBase::kNetwork), 2);
    frame.data[0] = static_cast<std::uint8_t>(command);
    frame.data[1] = node;
    return frame;
}

CanFrame sync_frame() { return frame_of(cob(CobBase::kSync), 0); }

CanFrame heartbeat_frame(std::uint8_t node, NetworkState state) {
    CanFrame frame = frame_of(cob(CobBase::kHeartbeat, node), 1);
    frame.data[0] = static_cast<std::uint8_t>(state);
    return frame;
}

CanFrame emergency_frame(std::uint8_t node, const Emergency& emergency) {
    CanFrame frame = frame_of(cob(CobBase::kEmergency, node), 8);
    store(frame, 0, 2, emergency.code);
    frame.data[2] = emergency.error_register;
    return frame;
}

std::optional<Emergency> read_emergency(const CanFrame& frame) {
    if (frame.length != 8) return std::nullopt;
    return Emergency{static_cast<std::uint16_t>(load(frame, 0, 2)), frame.data[2]};
}

const char* emergency_text(std::uint16_t code) {
    static constexpr std::array<std::pair<std::uint16_t, const char*>, 10> kTexts{
        {{0x2310, "over-current"},
         {0x3210, "supply voltage too high"},
         {0x3220, "supply voltage too low"},
         {0x4210, "too hot"},
         {0x7320, "position sensor"},
         {0x8110, "CAN overrun"},
         {0x8120, "CAN error-passive"},
         {0x8130, "it misses the master's heartbeat"},
         {0x8210, "process data of a wrong length"},
         {0x8611, "following error"}}};
    for (const auto& [known, text] : kTexts) {
        if (code == known) return text;
    }
    return "see the drive's manual";
}

CanFrame sdo_request(std::uint8_t node, const Sdo& request) {
    const std::uint32_t id = cob(CobBase::kSdoRequest, node);
    if (request.kind == SdoKind::kRead) return sdo_frame(id, 0x40, request, 0);
    if (request.kind == SdoKind::kAbort) return sdo_frame(id, 0x80, request, request.value);
    return sdo_frame(id, static_cast<std::uint8_t>(0x20U | size_bits(request.bytes)), request, request.value);
}

CanFrame sdo_reply(std::uint8_t node, const Sdo& reply) {
    const std::uint32_t id = cob(CobBase::kSdoReply, node);
    if (reply.kind == SdoKind::kWrite) return sdo_frame(id, 0x60, reply, 0);
    if (reply.kind == SdoKind::kAbort) return sdo_frame(id, 0x80, reply, reply.value);
    return sdo_frame(id, static_cast<std::uint8_t>(0x40U | size_bits(reply.bytes)), reply, reply.value);
}

std::optional<Sdo> read_sdo_request(const CanFrame& frame) {
    if (frame.length != 8) return std::nullopt;
    switch (frame.data[0] >> 5U) {
        case 1:
            return with_value(frame, SdoKind::kWrite);
        case 2:
            return sdo_of(frame, SdoKind::kRead);
        case 4:
            return sdo_of(frame, SdoKind::kAbort);
        default:
            return std::nullopt;
    }
}

std::optional<Sdo> read_sdo_reply(const CanFrame& frame) {
    if (frame.length != 8) return std::nullopt;
    switch (frame.data[0] >> 5U) {
        case 2:
            return with_value(frame, SdoKind::kRead);
        case 3:
            return sdo_of(frame, SdoKind::kWrite);
        case 4:
            return sdo_of(frame, SdoKind::kAbort);
        default:
            return std::nullopt;
    }
}

const char* abort_text(std::uint32_t code) {
    switch (static_cast<SdoAbort>(code)) {
        case SdoAbort::kTimeout:
            return "timeout";
        case SdoAbort::kUnknownCommand:
            return "unknown command";
        case SdoAbort::kReadOnly:
            return "read-only";
        case SdoAbort::kNoObject:
            return "no such object";
        case SdoAbort::kCannotMap:
            return "cannot be mapped";
        case SdoAbort::kMapTooLong:
            return "mapped data too long";
        case SdoAbort::kLength:
            return "length of the value";
        case SdoAbort::kNoSubIndex:
            return "no such sub-index";
        case SdoAbort::kValue:
            return "value out of range";
        case SdoAbort::kDeviceState:
            return "not in this state of the drive";
    }
    return "see the drive's manual";
}

}  // namespace thimble
