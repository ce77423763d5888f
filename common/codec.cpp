#include "common/codec.hpp"

#include <array>
#include <cmath>
#include <cstring>

#include "messages_generated.h"

namespace thimble {
namespace {

// Far outside anything a needle does, far inside what arithmetic can hold.
constexpr double kMaxPosition_m = 10;
constexpr double kMaxVelocity_m_per_s = 1000;
constexpr double kMaxForce_N = 1e5;
constexpr double kMaxTime_s = 1e6;
constexpr double kMaxEnergy_J = 1e6;
constexpr std::int64_t kMaxStamp_ns = std::int64_t{1} << 62;

template <class Enum>
constexpr auto raw(Enum value) {
    return static_cast<std::uint8_t>(value);
}

// Collects the verdict over all fields of a message: not finite beats out of range. One comparison pair per
// number, which NaN fails too, keeps the common path short.
class Judge {
  public:
    void number(double value, double limit) { number(value, -limit, limit); }
    void number(double value, double low, double high) {
        if (value >= low && value <= high) return;
        (std::isfinite(value) ? in_range_ : finite_) = false;
    }
    void stamp(std::int64_t nanoseconds) {
        if (nanoseconds < 0 || nanoseconds > kMaxStamp_ns) in_range_ = false;
    }
    template <class Enum>
    Enum choice(std::uint8_t value, Enum last) {
        if (value > raw(last)) in_range_ = false;
        return static_cast<Enum>(value);
    }
    Refusal verdict() const {
        if (!finite_) return Refusal::kNotFinite;
        return in_range_ ? Refusal::kCount : Refusal::kOutOfRange;
    }

  private:
    bool finite_ = true, in_range_ = true;
};

wire::Header to_wire(const Header& h) {
    return {h.instance, to_nanoseconds(h.send_time), h.sequence, h.trial, static_cast<wire::Role>(h.sender)};
}

Header from_wire(const wire::Header& w, Judge& judge) {
    judge.stamp(w.send_time_ns());
    return {w.instance(), from_nanoseconds(w.send_time_ns()), w.sequence(), w.trial(),
            judge.choice(raw(w.sender()), Role::kExperimenter)};
}

wire::NeedleCommand to_wire(const NeedleCommand& b) {
    return {b.position_needle_m, b.velocity_needle_m_per_s, b.position_needle_estimate_m,
            b.position_hand_m,   b.velocity_hand_m_per_s,   b.force_hand_N};
}

NeedleCommand from_wire(const wire::NeedleCommand& w, Judge& judge) {
    judge.number(w.position_needle_m(), kMaxPosition_m);
    judge.number(w.velocity_needle_m_per_s(), kMaxVelocity_m_per_s);
    judge.number(w.position_needle_estimate_m(), kMaxPosition_m);
    judge.number(w.position_hand_m(), kMaxPosition_m);
    judge.number(w.velocity_hand_m_per_s(), kMaxVelocity_m_per_s);
    judge.number(w.force_hand_N(), kMaxForce_N);
    return {w.position_needle_m(), w.velocity_needle_m_per_s(), w.position_needle_estimate_m(),
            w.position_hand_m(),   w.velocity_hand_m_per_s(),   w.force_hand_N()};
}

wire::ForceFeedback to_wire(const ForceFeedback& b) {
    return {b.position_needle_m, b.position_surface_m, b.velocity_surface_m_per_s,
            b.position_proxy_m,  b.force_tissue_N,     b.force_fixture_N,
            b.force_total_N,     b.contact_time_s,     to_nanoseconds(b.echo_time),
            b.hold_time.count(), b.echo_sequence,      static_cast<wire::TissuePhase>(b.phase),
            b.fixture_present,   b.needle_held};
}

ForceFeedback from_wire(const wire::ForceFeedback& w, Judge& judge) {
    judge.number(w.position_needle_m(), kMaxPosition_m);
    judge.number(w.position_surface_m(), kMaxPosition_m);
    judge.number(w.velocity_surface_m_per_s(), kMaxVelocity_m_per_s);
    judge.number(w.position_proxy_m(), kMaxPosition_m);
    judge.number(w.force_tissue_N(), kMaxForce_N);
    judge.number(w.force_fixture_N(), kMaxForce_N);
    judge.number(w.force_total_N(), 2 * kMaxForce_N);
    judge.number(w.contact_time_s(), 0, kMaxTime_s);
    judge.stamp(w.echo_time_ns());
    judge.stamp(w.hold_time_ns());
    return {w.position_needle_m(),
            w.position_surface_m(),
            w.velocity_surface_m_per_s(),
            w.position_proxy_m(),
            w.force_tissue_N(),
            w.force_fixture_N(),
            w.force_total_N(),
            w.contact_time_s(),
            from_nanoseconds(w.echo_time_ns()),
            Duration{w.hold_time_ns()},
            w.echo_sequence(),
            judge.choice(raw(w.phase()), TissuePhase::kPenetrated),
            w.fixture_present(),
            w.needle_held()};
}

wire::Percept to_wire(const Percept& b) {
    return {b.force_N,
            b.bar_N,
            b.position_needle_shown_m,
            b.position_surface_shown_m,
            b.sample_age_s,
            static_cast<wire::Finger>(b.finger),
            b.touching_shown,
            b.beep};
}

Percept from_wire(const wire::Percept& w, Judge& judge) {
    judge.number(w.force_N(), 0, kMaxForce_N);
    judge.number(w.bar_N(), 0, kMaxForce_N);
    judge.number(w.position_needle_shown_m(), kMaxPosition_m);
    judge.number(w.position_surface_shown_m(), kMaxPosition_m);
    judge.number(w.sample_age_s(), 0, kMaxTime_s);
    return {w.force_N(),
            w.bar_N(),
            w.position_needle_shown_m(),
            w.position_surface_shown_m(),
            w.sample_age_s(),
            judge.choice(raw(w.finger()), Finger::kThumb),
            w.touching_shown(),
            w.beep()};
}

wire::SessionControl to_wire(const SessionControl& b) {
    return {b.study_seed,
            b.fixture_position_m,
            b.network_delay_s,
            b.subject,
            b.experiment,
            static_cast<wire::ControlKind>(b.kind),
            static_cast<wire::Modality>(b.modality),
            b.fixture_present,
            static_cast<wire::EndReason>(b.reason)};
}

SessionControl from_wire(const wire::SessionControl& w, Judge& judge) {
    judge.number(w.fixture_position_m(), kMaxPosition_m);
    judge.number(w.network_delay_s(), 0, kMaxTime_s);
    return {w.study_seed(),
            w.fixture_position_m(),
            w.network_delay_s(),
            w.subject(),
            w.experiment(),
            judge.choice(raw(w.kind()), ControlKind::kNetworkChange),
            judge.choice(raw(w.modality()), Modality::kVF),
            w.fixture_present(),
            judge.choice(raw(w.reason()), EndReason::kInterrupted)};
}

wire::Heartbeat to_wire(const Heartbeat& b) {
    return {b.accepted,
            b.refused,
            b.round_trip_median_s,
            b.round_trip_worst_s,
            b.hold_median_s,
            b.force_hand_N,
            b.energy_in_J,
            static_cast<wire::NodeState>(b.state),
            static_cast<wire::EndReason>(b.reason)};
}

Heartbeat from_wire(const wire::Heartbeat& w, Judge& judge) {
    judge.number(w.round_trip_median_s(), 0, kMaxTime_s);
    judge.number(w.round_trip_worst_s(), 0, kMaxTime_s);
    judge.number(w.hold_median_s(), 0, kMaxTime_s);
    judge.number(w.force_hand_N(), kMaxForce_N);
    judge.number(w.energy_in_J(), kMaxEnergy_J);
    return {w.accepted(),
            w.refused(),
            w.round_trip_median_s(),
            w.round_trip_worst_s(),
            w.hold_median_s(),
            w.force_hand_N(),
            w.energy_in_J(),
            judge.choice(raw(w.state()), NodeState::kFailed),
            judge.choice(raw(w.reason()), EndReason::kInterrupted)};
}

wire::ClockProbe to_wire(const ClockProbe& b) { return wire::ClockProbe(to_nanoseconds(b.send_time)); }

ClockProbe from_wire(const wire::ClockProbe& w, Judge& judge) {
    judge.stamp(w.send_time_ns());
    return {from_nanoseconds(w.send_time_ns())};
}

wire::ClockReply to_wire(const ClockReply& b) {
    return {to_nanoseconds(b.probe_send_time), to_nanoseconds(b.probe_arrival_time)};
}

ClockReply from_wire(const wire::ClockReply& w, Judge& judge) {
    judge.stamp(w.probe_send_time_ns());
    judge.stamp(w.probe_arrival_time_ns());
    return {from_nanoseconds(w.probe_send_time_ns()), from_nanoseconds(w.probe_arrival_time_ns())};
}

wire::HandInput to_wire(const HandInput& b) { return {b.position_hand_m, b.engaged}; }

HandInput from_wire(const wire::HandInput& w, Judge& judge) {
    judge.number(w.position_hand_m(), kMaxPosition_m);
    return {w.position_hand_m(), w.engaged()};
}

wire::Monitor to_wire(const Monitor& b) {
    return {b.time_s,
            b.position_needle_m,
            b.position_surface_m,
            b.position_fixture_m,
            b.force_tissue_N,
            b.force_fixture_N,
            b.force_total_N,
            b.contact_time_s,
            b.force_hand_N,
            b.energy_in_J,
            b.round_trip_s,
            b.one_way_s,
            b.one_way_bound_s,
            b.network_delay_s,
            b.accepted,
            b.refused,
            b.subject,
            b.trials,
            static_cast<wire::TissuePhase>(b.phase),
            static_cast<wire::Modality>(b.modality),
            static_cast<wire::NodeState>(b.state),
            static_cast<wire::EndReason>(b.reason),
            b.fixture_present,
            b.needle_held,
            b.beeped,
            b.paused};
}

void judge_numbers(const wire::Monitor& w, Judge& judge) {
    for (const double position_m : {w.position_needle_m(), w.position_surface_m(), w.position_fixture_m()}) {
        judge.number(position_m, kMaxPosition_m);
    }
    for (const double force_N : {w.force_tissue_N(), w.force_fixture_N(), w.force_hand_N()}) {
        judge.number(force_N, kMaxForce_N);
    }
    judge.number(w.force_total_N(), 2 * kMaxForce_N);
    judge.number(w.energy_in_J(), kMaxEnergy_J);
    judge.number(w.one_way_s(), -1, kMaxTime_s);
    for (const double span_s :
         {w.time_s(), w.contact_time_s(), w.round_trip_s(), w.one_way_bound_s(), w.network_delay_s()}) {
        judge.number(span_s, 0, kMaxTime_s);
    }
}

Monitor from_wire(const wire::Monitor& w, Judge& judge) {
    judge_numbers(w, judge);
    return {w.time_s(),
            w.position_needle_m(),
            w.position_surface_m(),
            w.position_fixture_m(),
            w.force_tissue_N(),
            w.force_fixture_N(),
            w.force_total_N(),
            w.contact_time_s(),
            w.force_hand_N(),
            w.energy_in_J(),
            w.round_trip_s(),
            w.one_way_s(),
            w.one_way_bound_s(),
            w.network_delay_s(),
            w.accepted(),
            w.refused(),
            w.subject(),
            w.trials(),
            judge.choice(raw(w.phase()), TissuePhase::kPenetrated),
            judge.choice(raw(w.modality()), Modality::kVF),
            judge.choice(raw(w.state()), NodeState::kFailed),
            judge.choice(raw(w.reason()), EndReason::kInterrupted),
            w.fixture_present(),
            w.needle_held(),
            w.beeped(),
            w.paused()};
}

wire::Order to_wire(const Order& b) {
    return {b.value, b.trial, static_cast<wire::OrderKind>(b.kind), static_cast<wire::Modality>(b.modality)};
}

Order from_wire(const wire::Order& w, Judge& judge) {
    judge.number(w.value(), 0, kMaxTime_s);
    return {w.value(), w.trial(), judge.choice(raw(w.kind()), OrderKind::kSpeed),
            judge.choice(raw(w.modality()), Modality::kVF)};
}

wire::Page to_wire(const Page& b) {
    return {b.remaining_s, b.trial, b.trials, static_cast<wire::PageKind>(b.kind)};
}

Page from_wire(const wire::Page& w, Judge& judge) {
    judge.number(w.remaining_s(), 0, kMaxTime_s);
    return {w.remaining_s(), w.trial(), w.trials(), judge.choice(raw(w.kind()), PageKind::kWait)};
}

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
    return count;
}

constexpr std::size_t kMinBytes = sizeof(flatbuffers::uoffset_t) + flatbuffers::kFileIdentifierLength;

bool has_identifier(Bytes datagram) {
    return std::memcmp(datagram.data() + sizeof(flatbuffers::uoffset_t), wire::PacketIdentifier(),
                       flatbuffers::kFileIdentifierLength) == 0;
}

}  // namespace

Refusal decode_into(Bytes datagram, Message& message) {
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
    if (decoded.refusal != Refusal::kCount) decoded.message.reset();
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
