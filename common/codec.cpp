#include "common/codec.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <tuple>
#include <utility>

#include "common/codec_fields.hpp"
#include "messages_bfbs_generated.h"
#include "messages_generated.h"

namespace thimble {
namespace {

constexpr std::int64_t kMaxStamp_ns = std::int64_t{1} << 62;

// In the order of Body.
using WireBodies =
    std::tuple<wire::NeedleCommand, wire::ForceFeedback, wire::Percept, wire::SessionControl, wire::Heartbeat,
               wire::ClockProbe, wire::ClockReply, wire::HandInput, wire::Monitor, wire::Order, wire::Page,
               wire::ReplayState, wire::DeviceFault, wire::NeedleWave, wire::ForceWave, wire::StopOrder>;
constexpr std::size_t kKinds = std::variant_size_v<Body>;
static_assert(std::tuple_size_v<WireBodies> == kKinds && wire::Packet::VT_STOP_ORDER == 4 + 2 * kKinds);

// The field of Packet that holds this kind of body.
constexpr flatbuffers::voffset_t field_of(std::size_t kind) {
    return static_cast<flatbuffers::voffset_t>(wire::Packet::VT_NEEDLE_COMMAND + 2 * kind);
}

// Walks through a struct of the wire, which is aligned as ours are.
class FieldPlace {
  public:
    template <class Value>
    std::size_t next() {
        const std::size_t at = (end_ + alignof(Value) - 1) / alignof(Value) * alignof(Value);
        end_ = at + sizeof(Value);
        return at;
    }

  private:
    std::size_t end_ = 0;
};

class FieldWriter {
  public:
    explicit FieldWriter(std::uint8_t* out) : out_(out) {}

    void operator()(double value, const NumberRange&) { put(value); }
    void operator()(std::integral auto value) { put(value); }
    void operator()(std::uint32_t count, std::uint32_t) { put(count); }
    void operator()(SessionTime time) { put(to_nanoseconds(time)); }
    void operator()(Duration duration) { put(duration.count()); }
    void operator()(const NetworkName& name) { (*this)(name.text); }
    template <class Enum, class... Limits>
    requires std::is_enum_v<Enum>
    void operator()(Enum value, Limits...) { put(static_cast<std::uint8_t>(value)); }
    template <class Letter, std::size_t N>
    void operator()(const std::array<Letter, N>& text) {
        put(text);
    }

  private:
    template <class Value>
    void put(const Value& value) {
        std::memcpy(out_ + place_.next<Value>(), &value, sizeof value);
    }

    std::uint8_t* out_;
    FieldPlace place_;
};

// Collects the verdict over all fields of a message: not finite beats out of range. One comparison pair per
// number, which NaN fails too, keeps the common path short.
struct FieldVerdict {
    bool finite = true, in_range = true;

    void require(bool met) { in_range = in_range && met; }
    void number(double value, const NumberRange& range) {
        if (value >= range.low && value <= range.high) return;
        (std::isfinite(value) ? in_range : finite) = false;
    }
    void stamp(std::int64_t nanoseconds) { require(nanoseconds >= 0 && nanoseconds <= kMaxStamp_ns); }
    std::optional<Refusal> refusal() const {
        if (!finite) return Refusal::kNotFinite;
        return in_range ? std::nullopt : std::optional{Refusal::kOutOfRange};
    }
};

// Checks the fields of a struct as FieldReader checks those of bytes.
class FieldChecker {
  public:
    std::optional<Refusal> refusal() const { return verdict_.refusal(); }

    void operator()(double value, const NumberRange& range) { verdict_.number(value, range); }
    void operator()(std::integral auto) {}
    void operator()(std::uint32_t count, std::uint32_t most) { verdict_.require(count <= most); }
    void operator()(SessionTime time) { verdict_.stamp(to_nanoseconds(time)); }
    void operator()(Duration duration) { verdict_.stamp(duration.count()); }
    void operator()(const NetworkName& name) { verdict_.require(name.well_formed()); }
    template <class Enum>
    void operator()(Enum value, Enum last) {
        (*this)(value, Enum{}, last);
    }
    template <class Enum>
    void operator()(Enum value, Enum first, Enum last) {
        verdict_.require(value >= first && value <= last);
    }
    template <std::size_t N>
    void operator()(const std::array<char, N>& text) {
        verdict_.require(text.back() == '\0');
    }

  private:
    FieldVerdict verdict_;
};

class FieldReader {
  public:
    FieldReader(const std::uint8_t* in, FieldVerdict verdict) : in_(in), verdict_(verdict) {}

    FieldVerdict verdict() const { return verdict_; }

    void operator()(double& value, const NumberRange& range) { verdict_.number(take(value), range); }
    void operator()(std::integral auto& value) { take(value); }
    void operator()(bool& flag) { flag = byte() != 0; }
    void operator()(std::uint32_t& count, std::uint32_t most) { verdict_.require(take(count) <= most); }
    void operator()(SessionTime& time) { time = from_nanoseconds(stamp()); }
    void operator()(Duration& duration) { duration = Duration{stamp()}; }
    void operator()(NetworkName& name) {
        take(name.text);
        verdict_.require(name.well_formed());
    }
    template <class Enum>
    void operator()(Enum& value, Enum last) {
        (*this)(value, Enum{}, last);
    }
    template <class Enum>
    void operator()(Enum& value, Enum first, Enum last) {
        value = static_cast<Enum>(byte());
        verdict_.require(value >= first && value <= last);
    }
    // The text has an end for any bytes.
    template <std::size_t N>
    void operator()(std::array<char, N>& text) {
        take(text);
        verdict_.require(text.back() == '\0');
    }

  private:
    template <class Value>
    const Value& take(Value& value) {
        std::memcpy(&value, in_ + place_.next<Value>(), sizeof value);
        return value;
    }
    std::uint8_t byte() {
        std::uint8_t value = 0;
        return take(value);
    }
    std::int64_t stamp() {
        std::int64_t nanoseconds = 0;
        verdict_.stamp(take(nanoseconds));
        return nanoseconds;
    }

    const std::uint8_t* in_;
    FieldPlace place_;
    FieldVerdict verdict_;
};

// Flattened, so that the compiler knows the place of each field: twice as fast.
template <class Fields>
[[gnu::flatten]] void write_fields(std::uint8_t* out, const Fields& fields) {
    FieldWriter writer(out);
    visit_fields(writer, fields);
}

template <class Fields>
[[gnu::flatten]] std::optional<Refusal> check_fields(const Header& header, const Fields& fields) {
    FieldChecker checker;
    visit_fields(checker, header);
    visit_fields(checker, fields);
    return checker.refusal();
}

template <class Fields>
[[gnu::flatten]] FieldVerdict read_fields(const std::uint8_t* in, FieldVerdict verdict, Fields& fields) {
    FieldReader reader(in, verdict);
    visit_fields(reader, fields);
    return reader.verdict();
}

// Returns how many there are; `body` becomes the last of them.
template <std::size_t... Kinds>
int read_bodies(const flatbuffers::Table& packet, FieldVerdict& verdict, Body& body,
                std::index_sequence<Kinds...>) {
    int count = 0;
    const auto read = [&]<std::size_t kind>() {
        const auto* in = packet.GetStruct<const std::uint8_t*>(field_of(kind));
        if (in == nullptr) return;
        // By way of the stack: twice as fast as in place.
        std::variant_alternative_t<kind, Body> message;
        verdict = read_fields(in, verdict, message);
        body = message;
        ++count;
    };
    (read.template operator()<Kinds>(), ...);
    return count;
}

constexpr std::size_t kMinBytes = sizeof(flatbuffers::uoffset_t) + flatbuffers::kFileIdentifierLength;

bool has_identifier(Bytes datagram) {
    return std::memcmp(datagram.data() + sizeof(flatbuffers::uoffset_t), wire::PacketIdentifier(),
                       flatbuffers::kFileIdentifierLength) == 0;
}

}  // namespace

// A finished buffer of one kind, and where in it the two structs stand. All else that the verifier reads is before them.
struct MessageTemplate {
    flatbuffers::FlatBufferBuilder builder{kMaxDatagramBytes};
    std::uint8_t* header = nullptr;
    std::uint8_t* body = nullptr;

    template <class WireBody>
    MessageTemplate(flatbuffers::voffset_t field, const WireBody& empty) {
        const wire::Header empty_header;
        const auto start = builder.StartTable();
        builder.AddStruct(field, &empty);
        builder.AddStruct(wire::Packet::VT_HEADER, &empty_header);
        builder.Finish(flatbuffers::Offset<wire::Packet>(builder.EndTable(start)), wire::PacketIdentifier());
        auto* packet = flatbuffers::GetMutableRoot<flatbuffers::Table>(builder.GetBufferPointer());
        header = packet->GetStruct<std::uint8_t*>(wire::Packet::VT_HEADER);
        body = packet->GetStruct<std::uint8_t*>(field);
    }

    std::size_t place(const std::uint8_t* part) const {
        return static_cast<std::size_t>(part - builder.GetBufferPointer());
    }
    // True if the verifier needs no look: the datagram has the layout of this buffer, which it has accepted.
    bool is_layout_of(Bytes datagram) const {
        return datagram.size() == builder.GetSize() &&
               std::memcmp(datagram.data(), builder.GetBufferPointer(), place(std::min(header, body))) == 0;
    }
};

namespace {

template <std::size_t... Kinds>
std::array<MessageTemplate, kKinds> templates(std::index_sequence<Kinds...>) {
    return {MessageTemplate(field_of(Kinds), std::tuple_element_t<Kinds, WireBodies>())...};
}

const std::array<MessageTemplate, kKinds>& layouts() {
    static const auto made = templates(std::make_index_sequence<kKinds>());
    return made;
}

std::optional<Refusal> decode_as(const MessageTemplate& layout, Bytes datagram, Message& message) {
    FieldVerdict verdict = read_fields(datagram.data() + layout.place(layout.header), {}, message.header);
    std::visit(
        [&](auto& body) {
            std::remove_reference_t<decltype(body)> read;
            verdict = read_fields(datagram.data() + layout.place(layout.body), verdict, read);
            body = read;
        },
        message.body);
    return verdict.refusal();
}

std::optional<Refusal> decode_any(Bytes datagram, Message& message) {
    if (datagram.size() < kMinBytes) return Refusal::kTooShort;
    if (datagram.size() > kMaxDatagramBytes) return Refusal::kTooLong;
    if (!has_identifier(datagram)) return Refusal::kForeignFormat;
    flatbuffers::Verifier verifier(datagram.data(), datagram.size(), 4, 8);
    if (!verifier.VerifyBuffer<wire::Packet>(nullptr)) return Refusal::kMalformed;
    const auto& packet = *flatbuffers::GetRoot<flatbuffers::Table>(datagram.data());
    FieldVerdict verdict =
        read_fields(packet.GetStruct<const std::uint8_t*>(wire::Packet::VT_HEADER), {}, message.header);
    if (read_bodies(packet, verdict, message.body, std::make_index_sequence<kKinds>()) != 1)
        return Refusal::kNotOneBody;
    return verdict.refusal();
}

}  // namespace

// Most flows carry one kind of message. So the layout of the last datagram is tried first.
std::optional<Refusal> decode_into(Bytes datagram, Message& message) {
    const MessageTemplate& before = layouts()[message.body.index()];
    return before.is_layout_of(datagram) ? decode_as(before, datagram, message)
                                         : decode_any(datagram, message);
}

std::optional<Refusal> refusal_of(const Message& message) {
    return std::visit([&](const auto& body) { return check_fields(message.header, body); }, message.body);
}

Decoded decode(Bytes datagram) {
    Decoded decoded;
    decoded.refusal = decode_into(datagram, decoded.message.emplace());
    if (decoded.refusal) decoded.message.reset();
    return decoded;
}

// Copies of the layouts: dozens of encoders are made for each session.
struct Encoder::Templates {
    struct alignas(16) Buffer {
        std::array<std::uint8_t, kMaxDatagramBytes> bytes;
    };
    std::array<Buffer, kKinds> of_kind{};

    Templates() {
        for (std::size_t kind = 0; kind < kKinds; ++kind) {
            const auto& builder = layouts()[kind].builder;
            std::memcpy(of_kind[kind].bytes.data(), builder.GetBufferPointer(), builder.GetSize());
        }
    }
};

Encoder::Encoder() : templates_(std::make_unique<Templates>()) {}
Encoder::~Encoder() = default;
Encoder::Encoder(Encoder&&) noexcept = default;
Encoder& Encoder::operator=(Encoder&&) noexcept = default;

Bytes Encoder::encode(const Header& header, const Body& body) {
    const MessageTemplate& layout = layouts()[body.index()];
    std::uint8_t* const bytes = templates_->of_kind[body.index()].bytes.data();
    write_fields(bytes + layout.place(layout.header), header);
    std::visit([&](const auto& message) { write_fields(bytes + layout.place(layout.body), message); }, body);
    return {bytes, layout.builder.GetSize()};
}

const char* to_string(Refusal refusal) {
    static constexpr std::array kNames{
        "too_short",  "too_long",     "foreign_format",       "malformed",      "not_one_body",
        "not_finite", "out_of_range", "unexpected_kind",      "foreign_source", "second_sender",
        "duplicate",  "outdated",     "stamp_not_increasing", "wrong_trial"};
    static_assert(kNames.size() == static_cast<std::size_t>(Refusal::kCount));
    const auto index = static_cast<std::size_t>(refusal);
    return index < kNames.size() ? kNames[index] : "none";
}

Bytes wire_schema() { return {wire::PacketBinarySchema::data(), wire::PacketBinarySchema::size()}; }

}  // namespace thimble
