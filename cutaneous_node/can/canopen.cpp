#include "cutaneous_node/can/canopen.hpp"

#include <array>
#include <span>
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

// How client and server write their frames. One kind of theirs carries no value, the other one does.
struct SdoSide {
    CobBase base;
    SdoKind bare, valued;
    std::uint8_t bare_command, valued_command;
};
constexpr SdoSide kClient{CobBase::kSdoRequest, SdoKind::kRead, SdoKind::kWrite, 0x40, 0x20};
constexpr SdoSide kServer{CobBase::kSdoReply, SdoKind::kWrite, SdoKind::kRead, 0x60, 0x40};
constexpr std::uint8_t kAbortCommand = 0x80;

CanFrame write_sdo(const SdoSide& side, std::uint8_t node, const Sdo& sdo) {
    CanFrame frame = frame_of(cob(side.base, node), 8);
    frame.data[0] = sdo.kind == side.bare         ? side.bare_command
                    : sdo.kind == SdoKind::kAbort ? kAbortCommand
                                                  : side.valued_command | size_bits(sdo.bytes);
    store(frame, 1, 2, sdo.key.index);
    frame.data[3] = sdo.key.sub;
    store(frame, 4, 4, sdo.kind == side.bare ? 0 : sdo.value);
    return frame;
}

// The value of an expedited transfer; one without a size counts as four bytes.
std::optional<Sdo> read_sdo(const SdoSide& side, const CanFrame& frame) {
    if (frame.length != 8) return std::nullopt;
    Sdo sdo{side.bare, {static_cast<std::uint16_t>(load(frame, 1, 2)), frame.data[3]}, load(frame, 4, 4), 4};
    const unsigned command = frame.data[0] & 0xe0U;
    if (command == side.bare_command) return sdo;
    if (command == kAbortCommand) {
        sdo.kind = SdoKind::kAbort;
        return sdo;
    }
    if (command != side.valued_command || (frame.data[0] & 0x02) == 0) return std::nullopt;  // segmented
    sdo.kind = side.valued;
    if ((frame.data[0] & 0x01) != 0) sdo.bytes = static_cast<std::uint8_t>(4U - (frame.data[0] >> 2U & 3U));
    sdo.value = load(frame, 4, sdo.bytes);
    return sdo;
}

using CodeText = std::pair<std::uint32_t, const char*>;
const char* text_of(std::uint32_t code, std::span<const CodeText> known) {
    for (const auto& [one, text] : known) {
        if (one == code) return text;
    }
    return "see the drive's manual";
}

constexpr CodeText abort_row(SdoAbort abort, const char* text) {
    return {static_cast<std::uint32_t>(abort), text};
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
    static constexpr std::array<CodeText, 10> kTexts{{{0x2310, "over-current"},
                                                      {0x3210, "supply voltage too high"},
                                                      {0x3220, "supply voltage too low"},
                                                      {0x4210, "too hot"},
                                                      {0x7320, "position sensor"},
                                                      {0x8110, "CAN overrun"},
                                                      {0x8120, "CAN error-passive"},
                                                      {0x8130, "the master's heartbeat is missing"},
                                                      {0x8210, "process data of a wrong length"},
                                                      {0x8611, "following error"}}};
    return text_of(code, kTexts);
}

CanFrame sdo_request(std::uint8_t node, const Sdo& request) { return write_sdo(kClient, node, request); }
CanFrame sdo_reply(std::uint8_t node, const Sdo& reply) { return write_sdo(kServer, node, reply); }
std::optional<Sdo> read_sdo_request(const CanFrame& frame) { return read_sdo(kClient, frame); }
std::optional<Sdo> read_sdo_reply(const CanFrame& frame) { return read_sdo(kServer, frame); }

const char* abort_text(std::uint32_t code) {
    static constexpr std::array kTexts{
        abort_row(SdoAbort::kTimeout, "timeout"),
        abort_row(SdoAbort::kUnknownCommand, "unknown command"),
        abort_row(SdoAbort::kReadOnly, "read-only"),
        abort_row(SdoAbort::kNoObject, "no such object"),
        abort_row(SdoAbort::kCannotMap, "cannot be mapped"),
        abort_row(SdoAbort::kMapTooLong, "mapped data too long"),
        abort_row(SdoAbort::kLength, "wrong length of the value"),
        abort_row(SdoAbort::kNoSubIndex, "no such sub-index"),
        abort_row(SdoAbort::kValue, "value out of range"),
        abort_row(SdoAbort::kDeviceState, "not allowed in this state of the drive")};
    return text_of(code, kTexts);
}

}  // namespace thimble
