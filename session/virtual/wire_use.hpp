// Packets and bytes of the haptic flows of one trial, as they are on the wire between machines: what [codec] saves.
#pragma once

#include <array>
#include <cstddef>

#include "session/records/trial_record.hpp"
#include "session/settings/system_settings.hpp"

namespace thimble {

class NetemProcess;

struct FlowUse {
    double packets_per_s = 0;
    double bytes_per_s = 0;  // message, two seals (docs/security.md), headers of UDP and IPv4
};
// The needle comes first, then the force to master, to cutaneous and to visual, as in NetemProcess::relays().
using WireUse = std::array<FlowUse, 4>;

// The headers of UDP and IPv4.
inline constexpr std::size_t kHeaderBytes_IPv4_UDP = 28;
// Of a packet with a NeedleCommand or ForceFeedback, or with the packet of a controller that has two ends, sealed.
std::size_t haptic_packet_bytes(std::size_t flow, bool with_packets);

// Of the trial that has just ended, over its recorded samples.
WireUse wire_use(const ControlSettings& control, const NetemProcess& netem, const TrialRecord& record);

// The same session with this codec at both ends, and the slave's patience for it. Not with the compensator "wave".
SystemSettings with_codec(SystemSettings settings, const CodecSettings& codec);

struct CountedTrial {
    TrialRecord record;
    WireUse wire;
    double energy_in_J = 0;  // work of the hand on the handle; negative: more came out
};
// As run_virtual_trial, with what went over the wire.
CountedTrial run_counted_trial(const SystemSettings& settings, const TrialConditions& conditions);

}  // namespace thimble
