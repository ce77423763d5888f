#include "common/codec.hpp"

#include <array>
#include <cstring>

#include "common/codec_waves.hpp"

namespace thimble {
namespace {

// Returns how many there are; `body` becomes the last of them.
int read_bodies(const wire::Packet& p, Judge& judge, Body& body) {
    int count = 0;
    const auto read = [&](const auto* wire_body) {
        if (wire_body == nullptr) return;
        body = from_wire(*wire_body, judge);
        ++count;
    };
    read(p.needle_command());
    read(p.force_feedback());
    read(p.percept());
    read(p.session_control());
    read(p.heartbeat());
    read(p.clock_probe());
    read(p.clock_reply());
    read(p.hand_input());
    read(p.monitor());
    read(p.order());
    read(p.page());
    read(p.replay_state());
    read(p.device_fault());
    read(p.needle_wave());
    read(p.force_wave());
    read(p.stop_order());
    return count;
}

constexpr std::size_t kMinBytes = sizeof(flatbuffers::uoffset_t) + flatbuffers::kFileIdentifierLength;

bool has_identifier(Bytes datagram) {
    return std::memcmp(datagram.data() + sizeof(flatbuffers::uoffset_t), wire::PacketIdentifier(),
                       flatbuffers::kFileIdentifierLength) == 0;
}

}  // namespace

std::optional<Refusal> decode_into(Bytes datagram, Message& message) {
    if (datagram.size() < kMinBytes) return Refusal::kTooShort;
    if (datagram.size() > kMaxDatagramBytes) return Refusal::kTooLong;
    if (!has_identifier(datagram)) return Refusal::kForeignFormat;
    flatbuffers::Verifier verifier(datagram.data(), datagram.size(), 4, 8);
    if (!verifier.VerifyBuffer<wire::Packet>(nullptr)) return Refusal::kMalformed;
    const wire::Packet& packet = *wire::GetPacket(datagram.data());
    Judge judge;
    message.header = from_wire(*packet.header(), judge);
    if (read_bodies(packet, judge, message.body) != 1) return Refusal::kNotOneBody;
    return judge.verdict();
}

Decoded decode(Bytes datagram) {
    Decoded decoded;
    decoded.refusal = decode_into(datagram, decoded.message.emplace());
    if (decoded.refusal) decoded.message.reset();
    return decoded;
}

// One finished buffer and where in it the two structs stand.
template <class WireStruct>
class Template {
  public:
    explicit Template(flatbuffers::voffset_t field) : builder_(kMaxDatagramBytes) {
        const wire::Header header;
        const WireStruct body;
        const auto start = builder_.StartTable();
        builder_.AddStruct(field, &body);
        builder_.AddStruct(wire::Packet::VT_HEADER, &header);
        builder_.Finish(flatbuffers::Offset<wire::Packet>(builder_.EndTable(start)),
                        wire::PacketIdentifier());
        auto* packet = flatbuffers::GetMutableRoot<flatbuffers::Table>(builder_.GetBufferPointer());
        header_ = packet->GetStruct<std::uint8_t*>(wire::Packet::VT_HEADER);
        body_ = packet->GetStruct<std::uint8_t*>(field);
    }
    Bytes fill(const Header& header, const WireStruct& body) {
        const wire::Header wire_header = to_wire(header);
        std::memcpy(header_, &wire_header, sizeof wire_header);
        std::memcpy(body_, &body, sizeof body);
        return {builder_.GetBufferPointer(), builder_.GetSize()};
    }

  private:
    flatbuffers::FlatBufferBuilder builder_;
    std::uint8_t* header_;
    std::uint8_t* body_;
};

struct Encoder::Templates {
    Template<wire::NeedleCommand> needle_command{wire::Packet::VT_NEEDLE_COMMAND};
    Template<wire::ForceFeedback> force_feedback{wire::Packet::VT_FORCE_FEEDBACK};
    Template<wire::Percept> percept{wire::Packet::VT_PERCEPT};
    Template<wire::SessionControl> session_control{wire::Packet::VT_SESSION_CONTROL};
    Template<wire::Heartbeat> heartbeat{wire::Packet::VT_HEARTBEAT};
    Template<wire::ClockProbe> clock_probe{wire::Packet::VT_CLOCK_PROBE};
    Template<wire::ClockReply> clock_reply{wire::Packet::VT_CLOCK_REPLY};
    Template<wire::HandInput> hand_input{wire::Packet::VT_HAND_INPUT};
    Template<wire::Monitor> monitor{wire::Packet::VT_MONITOR};
    Template<wire::Order> order{wire::Packet::VT_ORDER};
    Template<wire::Page> page{wire::Packet::VT_PAGE};
    Template<wire::ReplayState> replay_state{wire::Packet::VT_REPLAY_STATE};
    Template<wire::DeviceFault> device_fault{wire::Packet::VT_DEVICE_FAULT};
    Template<wire::NeedleWave> needle_wave{wire::Packet::VT_NEEDLE_WAVE};
    Template<wire::ForceWave> force_wave{wire::Packet::VT_FORCE_WAVE};
    Template<wire::StopOrder> stop_order{wire::Packet::VT_STOP_ORDER};
};

Encoder::Encoder() : templates_(std::make_unique<Templates>()) {}
Encoder::~Encoder() = default;
Encoder::Encoder(Encoder&&) noexcept = default;
Encoder& Encoder::operator=(Encoder&&) noexcept = default;

Bytes Encoder::encode(const Header& header, const NeedleCommand& body) {
    return templates_->needle_command.fill(header, to_wire(body));
}
Bytes Encoder::encode(const Header& header, const ForceFeedback& body) {
    return templates_->force_feedback.fill(header, to_wire(body));
}
Bytes Encoder::encode(const Header& header, const Percept& body) {
    return templates_->percept.fill(header, to_wire(body));
}
Bytes Encoder::encode(const Header& header, const SessionControl& body) {
    return templates_->session_control.fill(header, to_wire(body));
}
Bytes Encoder::encode(const Header& header, const Heartbeat& body) {
    return templates_->heartbeat.fill(header, to_wire(body));
}
Bytes Encoder::encode(const Header& header, const ClockProbe& body) {
    return templates_->clock_probe.fill(header, to_wire(body));
}
Bytes Encoder::encode(const Header& header, const ClockReply& body) {
    return templates_->clock_reply.fill(header, to_wire(body));
}
Bytes Encoder::encode(const Header& header, const HandInput& body) {
    return templates_->hand_input.fill(header, to_wire(body));
}
Bytes Encoder::encode(const Header& header, const Monitor& body) {
    return templates_->monitor.fill(header, to_wire(body));
}
Bytes Encoder::encode(const Header& header, const Order& body) {
    return templates_->order.fill(header, to_wire(body));
}
Bytes Encoder::encode(const Header& header, const Page& body) {
    return templates_->page.fill(header, to_wire(body));
}
Bytes Encoder::encode(const Header& header, const ReplayState& body) {
    return templates_->replay_state.fill(header, to_wire(body));
}
Bytes Encoder::encode(const Header& header, const DeviceFault& body) {
    return templates_->device_fault.fill(header, to_wire(body));
}
Bytes Encoder::encode(const Header& header, const NeedleWave& body) {
    return templates_->needle_wave.fill(header, to_wire(body));
}
Bytes Encoder::encode(const Header& header, const ForceWave& body) {
    return templates_->force_wave.fill(header, to_wire(body));
}
Bytes Encoder::encode(const Header& header, const StopOrder& body) {
    return templates_->stop_order.fill(header, to_wire(body));
}
Bytes Encoder::encode(const Message& message) {
    return std::visit([&](const auto& body) { return encode(message.header, body); }, message.body);
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

}  // namespace thimble
