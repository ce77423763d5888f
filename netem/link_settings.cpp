#include "netem/link_settings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "netem/jitter_table.hpp"
#include "netem/packet_trace.hpp"

namespace thimble {
namespace {

constexpr Duration kPacketPeriod =
    std::chrono::milliseconds{1};  // every flow of a session but the heartbeats

// Share of all packets that are lost while the next is not: each burst ends once.
double bursts_per_packet(const LossSettings& loss) {
    if (loss.shape == LossShape::kIndependent) return loss.probability * (1 - loss.probability);
    if (loss.shape == LossShape::kFourState) {
        const std::array<double, 4> shares = four_state_shares(loss);
        return shares[2] * (loss.p31 + loss.p32) + shares[3];
    }
    const double bad = share_in_bad(loss);
    const double after_good =
        1 - loss.loss_in_good - loss.good_to_bad * (loss.loss_in_bad - loss.loss_in_good);
    const double after_bad = 1 - loss.loss_in_bad - loss.bad_to_good * (loss.loss_in_good - loss.loss_in_bad);
    return (1 - bad) * loss.loss_in_good * after_good + bad * loss.loss_in_bad * after_bad;
}

struct ShapeBounds {
    double least_mean;              // in spreads, so that cutting delays at 0 does not move the mean
    double nearly_largest_deviate;  // one in 10,000 exceeds it (of a normal one in 30,000)
};

ShapeBounds bounds_of(const JitterSettings& jitter) {
    // By JitterShape. Normal shapes: at two standard deviations the cut moves the mean by less than 1 % of one. Gamma is never cut;
    // ten times the mean is skewed enough, and of an exponential the deviate is 8.2. Pareto: (3/2 - 1) / sqrt(3/4) and
    // (10,000^(1/3) - 1.5) / 0.87 = 23.1.
    constexpr std::array<ShapeBounds, 6> kBounds{
        {{0, 0}, {1, 1}, {2, 4}, {0.1, 10}, {0.577350269, 24}, {2, 24}}};
    if (jitter.shape != JitterShape::kTable) return kBounds[static_cast<std::size_t>(jitter.shape)];
    return {std::max(0.0, -jitter.table->deviates().front()), jitter.table->deviates().back()};
}

// The mean, or the longest of a trace.
Duration longest_mean(const LinkSettings& link) {
    Duration mean = link.delay;
    if (link.trace != nullptr && link.trace->layout().has_delay) {
        for (const TraceRow& row : link.trace->rows()) mean = std::max(mean, row.delay);
    }
    return mean;
}

}  // namespace

double least_mean_in_spreads(const JitterSettings& jitter) { return bounds_of(jitter).least_mean; }

LossSettings LossSettings::independent(double probability) {
    LossSettings loss;
    loss.shape = probability > 0 ? LossShape::kIndependent : LossShape::kNone;
    loss.probability = probability;
    return loss;
}

// A burst ends with bad_to_good per packet; balance: (1 - P) good_to_bad = P bad_to_good.
LossSettings LossSettings::gilbert(double probability, double mean_burst) {
    LossSettings loss;
    loss.shape = probability > 0 ? LossShape::kGilbertElliott : LossShape::kNone;
    loss.bad_to_good = 1 / mean_burst;
    loss.good_to_bad = probability / (1 - probability) * loss.bad_to_good;
    return loss;
}

double share_in_bad(const LossSettings& loss) {
    const double moves = loss.good_to_bad + loss.bad_to_good;
    return moves > 0 ? loss.good_to_bad / moves : 0;
}

// Balance: pi1 p14 = pi4; pi1 p13 = pi3 p31; pi3 p32 = pi2 p23.
std::array<double, 4> four_state_shares(const LossSettings& loss) {
    const double lost_in_burst = loss.p13 > 0 ? loss.p13 / loss.p31 : 0;  // all relative to state 1
    const double received_in_burst = loss.p32 > 0 ? lost_in_burst * loss.p32 / loss.p23 : 0;
    const double sum = 1 + received_in_burst + lost_in_burst + loss.p14;
    return {1 / sum, received_in_burst / sum, lost_in_burst / sum, loss.p14 / sum};
}

double stationary_loss(const LossSettings& loss) {
    switch (loss.shape) {
        case LossShape::kNone:
            return 0;
        case LossShape::kIndependent:
            return loss.probability;
        case LossShape::kGilbertElliott:
            return loss.loss_in_good + share_in_bad(loss) * (loss.loss_in_bad - loss.loss_in_good);
        case LossShape::kFourState:
            return four_state_shares(loss)[2] + four_state_shares(loss)[3];
    }
    return 0;
}

double mean_loss_burst(const LossSettings& loss) {
    const double lost = stationary_loss(loss);
    if (lost <= 0) return 0;
    const double bursts = bursts_per_packet(loss);
    return bursts > 0 ? lost / bursts : std::numeric_limits<double>::infinity();
}

Duration nearly_longest_delay(const LinkSettings& link) {
    const double spread_ns = static_cast<double>(link.jitter.spread.count());
    return longest_mean(link) +
           Duration{std::llround(bounds_of(link.jitter).nearly_largest_deviate * spread_ns)};
}

std::size_t packets_in_flight(const LinkSettings& link) {
    return static_cast<std::size_t>((longest_mean(link) + link.jitter.spread) / kPacketPeriod + 1);
}

void make_room_for_delay(LinkSettings& link) {
    link.capacity = std::max(link.capacity, std::min(2 * packets_in_flight(link), kMostCapacity));
}

Duration mean_delay(const LinkSettings& link) {
    if (link.trace == nullptr || !link.trace->layout().has_delay) return link.delay;
    return std::chrono::microseconds{std::llround(link.trace->mean_delay_ns() / 1000)};
}

double mean_loss(const LinkSettings& link) {
    const bool traced = link.trace != nullptr && link.trace->layout().has_loss;
    return traced ? link.trace->mean_loss() : stationary_loss(link.loss);
}

Duration least_delay(const LinkSettings& link) {
    if (link.reorder > 0 || link.jitter.shape != JitterShape::kNone) return {};
    if (link.trace == nullptr || !link.trace->layout().has_delay) return link.delay;
    const std::vector<TraceRow>& rows = link.trace->rows();
    return std::min_element(rows.begin(), rows.end(),
                            [](const TraceRow& a, const TraceRow& b) { return a.delay < b.delay; })
        ->delay;
}

void set_delay(LinkSettings& link, Duration delay) {
    if (link.delay == delay) return;
    link.delay = delay;
    make_room_for_delay(link);
}

}  // namespace thimble
