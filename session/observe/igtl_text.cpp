#include "session/observe/igtl_text.hpp"

#include <array>
#include <igtlSensorMessage.h>
#include <igtlStatusMessage.h>
#include <igtlStringMessage.h>
#include <igtlTransformMessage.h>
#include <igtlUnit.h>
#include <string>

#include <fmt/format.h>

namespace thimble {
namespace {

constexpr double kMillimetres_per_m = 1000;

void stamp(igtl::MessageBase& message, std::int64_t date_ns) {
    constexpr std::int64_t kSecond_ns = 1'000'000'000;
    auto time = igtl::TimeStamp::New();
    time->SetTime(static_cast<igtlUint32>(date_ns / kSecond_ns),
                  static_cast<igtlUint32>(date_ns % kSecond_ns));
    message.SetTimeStamp(time);
}

Bytes packed(igtl::MessageBase& message) {
    message.Pack();
    return {static_cast<const std::uint8_t*>(message.GetPackPointer()),
            static_cast<std::size_t>(message.GetPackSize())};
}

void place(igtl::TransformMessage& message, double position_m) {
    igtl::Matrix4x4 matrix;
    igtl::IdentityMatrix(matrix);
    matrix[2][3] = static_cast<float>(kMillimetres_per_m * position_m);
    message.SetMatrix(matrix);
}

int code_of(const Monitor& monitor, bool silent) {
    if (silent) return igtl::StatusMessage::STATUS_TIME_OUT;
    if (monitor.state == NodeState::kRunning) return igtl::StatusMessage::STATUS_OK;
    if (is_stop(monitor.reason)) return igtl::StatusMessage::STATUS_PANICK_MODE;
    switch (monitor.reason) {
        case EndReason::kDeviceFault:
            return igtl::StatusMessage::STATUS_HARDWARE_FAILURE;
        case EndReason::kPeerLost:
            return igtl::StatusMessage::STATUS_TIME_OUT;
        default:
            return igtl::StatusMessage::STATUS_NOT_READY;  // between trials
    }
}

// Of at most 19 letters, which is what there is room for.
std::string name_of(const Monitor& monitor, bool silent) {
    if (silent) return "no session";
    if (monitor.state == NodeState::kRunning) return "running";
    return monitor.reason == EndReason::kNone ? "waiting" : to_string(monitor.reason);
}

}  // namespace

struct IgtlText::Messages {
    igtl::TransformMessage::Pointer needle = igtl::TransformMessage::New(),
                                    surface = igtl::TransformMessage::New();
    igtl::SensorMessage::Pointer force = igtl::SensorMessage::New();
    igtl::StringMessage::Pointer state = igtl::StringMessage::New();
    igtl::StatusMessage::Pointer status = igtl::StatusMessage::New();
};

IgtlText::IgtlText() : messages_(std::make_unique<Messages>()) {
    messages_->needle->SetDeviceName("Needle");
    messages_->surface->SetDeviceName("Surface");
    messages_->force->SetDeviceName("Force");
    messages_->state->SetDeviceName("State");
    messages_->status->SetDeviceName("Thimble");
    auto unit = igtl::Unit::New();
    unit->Append(igtl::Unit::SI_DERIVED_NEWTON, 1);
    messages_->force->SetUnit(unit);
}

IgtlText::~IgtlText() = default;

Bytes IgtlText::needle(std::int64_t date_ns, const Monitor& monitor) {
    place(*messages_->needle, monitor.position_needle_m);
    stamp(*messages_->needle, date_ns);
    return packed(*messages_->needle);
}

Bytes IgtlText::surface(std::int64_t date_ns, const Monitor& monitor) {
    place(*messages_->surface, monitor.position_surface_m);
    stamp(*messages_->surface, date_ns);
    return packed(*messages_->surface);
}

Bytes IgtlText::force(std::int64_t date_ns, const Monitor& m) {
    std::array<igtlFloat64, 4> values{m.force_total_N, m.force_tissue_N, m.force_fixture_N, m.force_hand_N};
    messages_->force->SetLength(values.size());
    messages_->force->SetValue(values.data());
    stamp(*messages_->force, date_ns);
    return packed(*messages_->force);
}

Bytes IgtlText::state(std::int64_t date_ns, std::uint32_t trial, const Monitor& m) {
    std::string text = fmt::format("trial {} {} {} {:.2f} N{}", trial, to_string(m.modality),
                                   to_string(m.phase), m.force_total_N, m.beeped ? " beeped" : "");
    messages_->state->SetString(text);
    stamp(*messages_->state, date_ns);
    return packed(*messages_->state);
}

Bytes IgtlText::status(std::int64_t date_ns, const Monitor& monitor, bool silent) {
    const std::string name = name_of(monitor, silent);
    messages_->status->SetCode(code_of(monitor, silent));
    messages_->status->SetSubCode(0);
    messages_->status->SetErrorName(name.c_str());
    messages_->status->SetStatusString(name.c_str());
    stamp(*messages_->status, date_ns);
    return packed(*messages_->status);
}

}  // namespace thimble
