#include "session/virtual/wire_use.hpp"

#include <algorithm>

#include "common/codec.hpp"
#include "common/control/built_in_controllers.hpp"
#include "common/security/sealing.hpp"
#include "session/virtual/virtual_session.hpp"

namespace thimble {
namespace {

// One between master or slave_sim and netem, one from end to end.
constexpr std::size_t kSeals = 2;

template <class Body>
std::size_t message_bytes() {
    Encoder encoder;
    return encoder.encode(Header{}, Body{}).size();
}

}  // namespace

std::size_t haptic_packet_bytes(std::size_t flow, bool with_packets) {
    static const std::size_t command = message_bytes<NeedleCommand>(), force = message_bytes<ForceFeedback>(),
                             command_wave = message_bytes<NeedleWave>(),
                             force_wave = message_bytes<ForceWave>();
    const std::size_t around = kSeals * kSealOverheadBytes + kHeaderBytes_IPv4_UDP;
    if (flow == 0) return around + (with_packets ? command_wave : command);
    return around + (with_packets && flow == 1 ? force_wave : force);
}

WireUse wire_use(const ControlSettings& control, const NetemProcess& netem, const TrialRecord& record) {
    WireUse use;
    const bool with_packets = record.conditions.modality == Modality::kHF && has_two_ends(control);
    if (record.samples.empty() || record.samples.back().time_s <= 0) return use;
    const double duration_s = record.samples.back().time_s;
    for (std::size_t flow = 0; flow < use.size(); ++flow) {
        const auto packets = static_cast<double>(netem.relays().at(flow).model.counters().pushed);
        use.at(flow).packets_per_s = packets / duration_s;
        use.at(flow).bytes_per_s =
            packets * static_cast<double>(haptic_packet_bytes(flow, with_packets)) / duration_s;
    }
    return use;
}

SystemSettings with_codec(SystemSettings settings, const CodecSettings& codec) {
    settings.master.codec = settings.slave.codec = codec;
    if (codec.command != HapticCodec::kNone)
        settings.slave.stale_after = std::max(settings.slave.stale_after, codec.slave_patience());
    return settings;
}

CountedTrial run_counted_trial(const SystemSettings& settings, const TrialConditions& conditions) {
    VirtualSession session(with_force_delay(settings, from_seconds(conditions.delay_s)));
    CountedTrial trial;
    trial.record = session.run(conditions);
    trial.wire = wire_use(settings.master.control, session.netem(), trial.record);
    trial.energy_in_J = session.master().energy().energy_in_J();
    return trial;
}

}  // namespace thimble
