// Link settings as people write them, one table per direction. docs/network.md says what each does.
//   delay_s = 0.05              mean one-way delay, 0 to 60
//   jitter = "normal"           "none", "uniform", "normal", "gamma", "pareto", "pareto-normal" or "table"
//   jitter_spread_s = 0.005     half width (uniform) or standard deviation (all others)
//   jitter_correlation = 0.5    of successive packets, 0 to below 1
//   jitter_table = "wifi.dist"  the shape of jitter = "table", as iproute2 has them
//   loss = 0.01                 share of packets, independent; with loss_burst = 3 in bursts of so many on average
//   [loss]                      or a table: model = "independent", "gilbert", "gilbert-elliott" or "four-state"
//   duplicate, corrupt          probabilities; corrupt_bits = 1: how many bits are flipped then
//   reorder, reorder_gap        probability that (each n-th) packet skips the delay; needs in_order = false
//   in_order = true             false: packets may overtake each other
//   rate_bits_per_s = 1e6       and rate_overhead_bytes per packet; rate_queue_packets, rate_queue_bytes: what may
//   rate_drop = "tail"          wait, 0: anything; "tail" drops the newest, "head" the oldest
//   slot_least_s, slot_most_s   the medium sends in bursts, so far apart; slot_packets, slot_bytes at most in each
//   [[outage]]                  start_s, length_s, every_s: nothing gets through
//   trace = "leo.csv"           delay, loss and rate by time or packet; trace_by, trace_between, trace_end
//   deliveries = "lte.up"       mahimahi's delivery opportunities instead of a rate
//   capacity = 4096             packets in flight; by itself at least twice what the delay needs at 1 kHz
//   profile = "leo"             begins with these settings; other keys replace some of them
//   [[timeline]]                at_s and any of the keys above: what changes then; the rest stays
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/config.hpp"
#include "netem/link_settings.hpp"
#include "netem/packet_trace.hpp"

namespace thimble {

struct TraceRequest {
    std::string file;
    bool by_given = false;  // false: as the file has it
    TraceBy by = TraceBy::kTime;
    TraceBetween between = TraceBetween::kHold;
    TraceEnd end = TraceEnd::kWrap;
};

// Functions that read the files and profiles that a link may name. The reader itself opens none. Without one of these the key
// that needs it is refused.
struct LinkSources {
    std::function<std::shared_ptr<const JitterTable>(const std::string& file)> jitter_table{};
    std::function<std::shared_ptr<const PacketTrace>(const TraceRequest& request)> trace{};
    std::function<std::shared_ptr<const DeliveryTrace>(const std::string& file)> deliveries{};
    std::function<LinkSettings(const std::string& name)> profile{};
};

// A key that is absent leaves what `base` (or the profile) says. Throws Error (usage) also for settings that
// contradict each other: a spread without jitter or the reverse, a spread so wide that cutting delays at 0 would move
// their mean, a capacity that the delay alone fills, reordering in order, two senders at once.
LinkSettings read_link_settings(const ConfigTable& table, const LinkSettings& base = {},
                                const LinkSources& sources = {});

// The [[timeline]] of a table whose other keys gave `base`: each entry begins with the settings before it.
Timeline read_timeline(const ConfigTable& table, const LinkSettings& base, const LinkSources& sources = {});

// The key `loss` of a link: a number, with loss_burst beside it, or a table of its own.
//   [netem.force.loss]
//   model = "independent"      share
//   model = "gilbert"          share and mean_burst; or good_to_bad and bad_to_good
//   model = "gilbert-elliott"  good_to_bad, bad_to_good, loss_in_good, loss_in_bad
//   model = "four-state"       p13, p31, p32, p23, p14

// Packets in the mean, that a file may ask for.
inline constexpr double kLongestBurst = 1e6;

// Where the key is absent, `base`. Throws Error (usage).
LossSettings read_loss(const ConfigTable& link, const LossSettings& base);

}  // namespace thimble
