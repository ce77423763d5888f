// The settings of one direction of one flow. A LinkModel carries it out; link_reader.hpp reads it
// from TOML. Each part that is left at its default does nothing and costs nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "common/time.hpp"

namespace thimble {

class JitterTable;    // a measured shape, e.g. of iproute2 (jitter_table.hpp)
class PacketTrace;    // delay, loss and rate by packet or by time (packet_trace.hpp)
class DeliveryTrace;  // when a link could send, as mahimahi records it (delivery_trace.hpp)

enum class JitterShape : std::uint8_t {
    kNone,
    kUniform,
    kNormal,
    kGamma,         // skewness 2 spread / delay: shape (delay / spread)^2, so that no delay is below 0
    kPareto,        // index 3
    kParetoNormal,  // a quarter normal, three quarters Pareto, as netem's table
    kTable
};
// In the order of JitterShape; what files and reports call them.
inline constexpr std::array<std::string_view, 7> kJitterShapeNames{
    "none", "uniform", "normal", "gamma", "pareto", "pareto-normal", "table"};
constexpr std::string_view to_string(JitterShape shape) {
    return kJitterShapeNames[static_cast<std::size_t>(shape)];
}

// Delay = mean + spread * deviate, deviates of mean 0 and standard deviation 1, cut where the delay would be
// below 0. kUniform alone: `spread` is the half width.
struct JitterSettings {
    JitterShape shape = JitterShape::kNone;
    Duration spread{};
    // Of successive packets: deviates are the shape's quantiles of an AR(1) Gaussian with this coefficient, [0, 1).
    // The marginal is the shape, whatever the correlation.
    double correlation = 0;
    std::shared_ptr<const JitterTable> table{};  // kTable

    bool operator==(const JitterSettings&) const = default;
};

// How many spreads the mean delay must lie above 0, so that cutting delays there does not move it.
double least_mean_in_spreads(const JitterSettings& jitter);

enum class LossShape : std::uint8_t { kNone, kIndependent, kGilbertElliott, kFourState };

// kIndependent: `probability`. kGilbertElliott (Gilbert: no loss in good, all lost in bad): a packet is lost with
// the probability of the state it finds; the chain then moves once per packet. kFourState: states 1 received in a
// gap, 2 received in a burst, 3 lost in a burst, 4 lost alone (Salsano, Ludovici, Ordine and Giannuzzi 2012, netem's
// "loss state"). The first packet finds the chain in its stationary distribution.
struct LossSettings {
    LossShape shape = LossShape::kNone;
    double probability = 0;
    double good_to_bad = 0, bad_to_good = 1;
    double loss_in_good = 0, loss_in_bad = 1;
    double p13 = 0, p31 = 1, p32 = 0, p23 = 0, p14 = 0;

    static LossSettings independent(double probability);
    // Gilbert: bursts of `mean_burst` packets on average (1 or more), so many that a share of `probability` is lost, in
    // [0, mean_burst / (1 + mean_burst)].
    static LossSettings gilbert(double probability, double mean_burst);
    bool operator==(const LossSettings&) const = default;
};

// Share of packets that is lost in the long run, [0, 1].
double stationary_loss(const LossSettings& loss);
// How many packets in a row are lost on average, once one is; 0 if none ever is, infinity if all are.
double mean_loss_burst(const LossSettings& loss);
// Share of packets that find a kGilbertElliott chain in "bad"; that find a kFourState chain in states 1 to 4 (p31 above
// 0 if p13 is, p23 if p32 is).
double share_in_bad(const LossSettings& loss);
std::array<double, 4> four_state_shares(const LossSettings& loss);

enum class Drop : std::uint8_t { kTail, kHead };  // who goes when the queue is full: the newest or the oldest

// A transmitter that takes (size + overhead) * 8 / bits_per_s per packet; what waits for it queues. With cells it sends
// whole ones: (size + overhead) / cell_bytes of them, rounded up, each with cell_overhead_bytes on top.
struct RateSettings {
    double bits_per_s = 0;  // 0: no limit
    std::size_t overhead_bytes = 0;
    std::size_t queue_packets = 0, queue_bytes = 0;  // waiting, without the one being sent; 0: no limit
    Drop drop = Drop::kTail;
    std::size_t cell_bytes = 0, cell_overhead_bytes = 0;  // 0: no cells

    // A packet of `size` bytes takes so many bytes of the rate.
    std::size_t bytes_on_air(std::size_t size) const {
        const std::size_t bytes = size + overhead_bytes;
        if (cell_bytes == 0) return bytes;
        return (bytes + cell_bytes - 1) / cell_bytes * (cell_bytes + cell_overhead_bytes);
    }
    bool operator==(const RateSettings&) const = default;
};

// A medium that sends in bursts (Wi-Fi, cable): packets wait for the next slot; slots are [least, most] apart,
// uniform; each carries at most so many packets and bytes. Another shape has its mean in the middle of the two and a
// spread of half their difference; no slot is shorter than 0.
struct SlotSettings {
    Duration least{}, most{};            // most = 0: no slots
    std::size_t packets = 0, bytes = 0;  // 0: no limit
    JitterShape shape = JitterShape::kUniform;
    std::shared_ptr<const JitterTable> table{};  // kTable

    bool operator==(const SlotSettings&) const = default;
};

// No packet gets through from `start` (since the start of the trial) for `length`; repeated each `every` if that is
// not 0.
struct Outage {
    Duration start{}, length{}, every{};
    bool operator==(const Outage&) const = default;
};

inline constexpr std::size_t kMostCapacity = 1'000'000;

struct LinkSettings {
    Duration delay{};  // mean one-way delay
    JitterSettings jitter{};
    LossSettings loss{};
    double duplicate = 0;       // probability that a packet arrives twice, each with a delay of its own
    double corrupt = 0;         // probability that bits of a packet are flipped
    unsigned corrupt_bits = 1;  // how many then, all different
    double reorder = 0;         // probability that a packet skips the delay, as in netem
    unsigned reorder_gap = 1;   // only each n-th packet may
    bool in_order = true;       // a packet never leaves before an earlier one (due times are raised)
    bool ecn = false;           // a packet that understands ECN is marked instead of lost, as in netem
    RateSettings rate{};
    SlotSettings slot{};
    std::vector<Outage> outages{};
    std::shared_ptr<const PacketTrace> trace{};  // delay and loss instead of the above, where it gives them
    std::shared_ptr<const DeliveryTrace> deliveries{};  // instead of `rate`
    std::size_t capacity = 4096;                        // packets in flight; one more is dropped and counted

    bool operator==(const LinkSettings&) const = default;
};

// The longest delay but for one packet in 10,000: the mean, or the longest of a trace, plus jitter. Queues, slots and outages come on top.
Duration nearly_longest_delay(const LinkSettings& link);
// Packets of a flow of 1 kHz that are in flight at the mean delay, or the longest of a trace, plus one spread.
std::size_t packets_in_flight(const LinkSettings& link);
// Raises the capacity to twice that number, up to kMostCapacity.
void make_room_for_delay(LinkSettings& link);
// Of all packets: `delay`, or the mean over one period of a trace that has delays, to the microsecond.
Duration mean_delay(const LinkSettings& link);
// Of all packets: the share that is lost in the long run, or the mean over one period of a trace that has losses.
double mean_loss(const LinkSettings& link);
// No packet is quicker. Zero with jitter, or where packets may skip the delay.
Duration least_delay(const LinkSettings& link);
// With room for it. The same delay changes nothing.
void set_delay(LinkSettings& link, Duration delay);

// These settings replace the earlier ones at `at` after the start of a trial.
struct LinkChange {
    Duration at{};
    LinkSettings settings;
    bool operator==(const LinkChange&) const = default;
};
using Timeline = std::vector<LinkChange>;  // sorted by `at`

}  // namespace thimble
