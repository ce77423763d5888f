// Traces in files. Every refusal is an Error (data) that names file and line.
//
// Delay, loss and rate as CSV. A header names the columns, in any order:
//   time_s (or t_s, t_ms, t_us, t_ns)   since the start of the trial, rising strictly
//   packet                              its number instead, rising strictly
//   delay_s (or delay_ms, delay_us, delay_ns)   may be empty where loss is 1: the delay before it holds on
//   loss                                0 to 1
//   rate_bits_per_s (or rate_kbps)      above 0
// Lines of '#' are comments. Written files use our names. The other names are those of such files elsewhere.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "netem/delivery_trace.hpp"
#include "netem/formats/measured_path.hpp"
#include "netem/packet_trace.hpp"

namespace thimble {

MeasuredPath parse_path(std::string_view text, std::string_view name);
// The columns that the path has; remarks stand in front as comments. To the nanosecond.
std::string print_path(const MeasuredPath& path);

struct TraceChoice {
    std::optional<TraceBy> by{};  // none: by time if the file has times, else by packet
    TraceBetween between = TraceBetween::kHold;
    TraceEnd end = TraceEnd::kWrap;
};

// By packet, a file with times counts its lines from 0: the recorded fates, whatever the timing of today's packets.
PacketTrace to_trace(const MeasuredPath& path, const TraceChoice& choice, std::string_view name);
PacketTrace parse_packet_trace(std::string_view text, std::string_view name, const TraceChoice& choice);

// mahimahi's packet-delivery traces: a whole number of milliseconds per line, not falling; each line lets 1500 bytes
// through at that time, and the last one is where the trace begins again.
DeliveryTrace parse_delivery_trace(std::string_view text, std::string_view name);

}  // namespace thimble
