#include "netem/relay/selftest_twin.hpp"

#include <algorithm>
#include <cmath>

#include "netem/link_model.hpp"

namespace thimble {
namespace {

constexpr std::size_t kTwins = 20;  // to compare with, and as many to be compared
constexpr double kLeastSpread_s = 50e-6;

// The traffic, too, takes the first copy that arrives.
void take_due(LinkModel& model, SessionTime now, std::vector<bool>& left, TwinOutcome& outcome) {
    for (auto out = model.pop_departure(now); !out.bytes.empty(); out = model.pop_departure(now)) {
        if (!out.copy) outcome.dropped_packet[out.packet] = false;
        if (left[out.packet]) continue;
        left[out.packet] = true;
        outcome.delays_s.push_back(to_seconds(out.due - out.received));
    }
}

// Of sorted delays.
bool is_spread(const std::vector<double>& delays_s) {
    const std::size_t n = delays_s.size();
    return n >= 100 && delays_s[n * 99 / 100] - delays_s[n / 100] > kLeastSpread_s;
}

}  // namespace

TwinOutcome replay(const TwinLink& link, std::span<const SessionTime> received, std::size_t bytes) {
    LinkModel model(link.settings, link.key, link.direction, link.timeline, link.start, link.opened);
    TwinOutcome outcome;
    outcome.dropped_packet.resize(received.size(), true);
    std::vector<bool> left(received.size());
    const std::vector<std::uint8_t> datagram(bytes);
    for (const SessionTime now : received) {
        take_due(model, now, left, outcome);
        model.push(now, datagram);
    }
    while (model.next_due() != kNever) take_due(model, model.next_due(), left, outcome);
    const auto dropped = std::count(outcome.dropped_packet.begin(), outcome.dropped_packet.end(), true);
    outcome.dropped = static_cast<std::uint64_t>(dropped);
    return outcome;
}

double ks_distance(std::vector<double>& a, std::vector<double>& b) {
    if (a.empty() || b.empty()) return a.empty() && b.empty() ? 0 : 1;
    std::sort(a.begin(), a.end());
    std::sort(b.begin(), b.end());
    double worst = 0;
    for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
        const double x = std::min(a[i], b[j]);
        while (i < a.size() && a[i] <= x) ++i;
        while (j < b.size() && b[j] <= x) ++j;
        worst = std::max(worst, std::abs(static_cast<double>(i) / static_cast<double>(a.size()) -
                                         static_cast<double>(j) / static_cast<double>(b.size())));
    }
    return worst;
}

Comparison compare(const TwinLink& link, std::span<const SessionTime> received, std::size_t bytes,
                   std::vector<double> achieved_s) {
    Comparison result;
    double dropped = 0;
    const auto twin = [&](std::size_t i) {
        TwinLink other = link;
        other.key.study += 1 + i;
        TwinOutcome outcome = replay(other, received, bytes);
        dropped += static_cast<double>(outcome.dropped);
        return std::move(outcome.delays_s);
    };
    std::vector<double> pool;
    for (std::size_t i = 0; i < kTwins; ++i) {
        const std::vector<double> delays_s = twin(i);
        pool.insert(pool.end(), delays_s.begin(), delays_s.end());
    }
    std::sort(pool.begin(), pool.end());
    result.spread = is_spread(pool);
    std::vector<double> distances;
    for (std::size_t i = 0; i < kTwins; ++i) {
        std::vector<double> delays_s = twin(kTwins + i);
        distances.push_back(ks_distance(delays_s, pool));
    }
    std::sort(distances.begin(), distances.end());
    result.by_chance = distances[kTwins * 95 / 100 - 1];
    result.distance = ks_distance(achieved_s, pool);
    result.dropped_mean = dropped / (2 * kTwins);
    return result;
}

}  // namespace thimble
