// Bytes <-> messages. Every datagram is verified as a FlatBuffer, must hold exactly one body, and every
// number in it must be finite and in range before anything else sees it. docs/protocol.md lists the ranges.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "common/channel.hpp"
#include "common/messages.hpp"

namespace thimble {

// messages.fbs as FlatBuffers writes schemas down (reflection.fbs): made by flatc at build time, and part of every log.
inline constexpr const char* kWireSchemaName = "thimble.wire.Packet";
Bytes wire_schema();

// Why a datagram was refused; each has a counter of this name in every node's report.
enum class Refusal : std::uint8_t {
    kTooShort,
    kTooLong,
    kForeignFormat,       // not our file identifier
    kMalformed,           // the FlatBuffers verifier said no
    kNotOneBody,          // none or several
    kNotFinite,           // NaN or infinity in any field
    kOutOfRange,          // a quantity or an enum outside its range
    kUnexpectedKind,      // a valid message on the wrong channel or from the wrong role
    kForeignSource,       // from a host that is not the configured peer
    kSecondSender,        // another instance than the one that speaks on this flow
    kDuplicate,           // sequence already seen
    kOutdated,            // an older sequence than the newest
    kStampNotIncreasing,  // newer sequence, but the sender's clock went backwards
    kWrongTrial,          // for a trial that is not running
    kCount,
};

const char* to_string(Refusal refusal);

struct Decoded {
    std::optional<Message> message;
    std::optional<Refusal> refusal{};  // none with a message
};

// `datagram` must begin at an address that is a multiple of 8, as every channel's buffer does.
Decoded decode(Bytes datagram);
// The same without moving the message afterwards. No refusal: `message` is good; else it is unspecified.
std::optional<Refusal> decode_into(Bytes datagram, Message& message);
// The refusal that decode() would give for the bytes of `message`. None: decode() gives the same struct.
std::optional<Refusal> refusal_of(const Message& message);

// Every body is one struct, so all messages of a kind have the same layout: the buffer of each kind is built
// once and its structs are overwritten in place. The bytes are valid until the next call with the same kind
// of body.
class Encoder {
  public:
    Encoder();
    ~Encoder();
    Encoder(Encoder&&) noexcept;
    Encoder& operator=(Encoder&&) noexcept;

    Bytes encode(const Header& header, const Body& body);
    Bytes encode(const Message& message) { return encode(message.header, message.body); }

  private:
    struct Templates;
    std::unique_ptr<Templates> templates_;
};

}  // namespace thimble
