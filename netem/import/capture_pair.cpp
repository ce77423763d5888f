#include <algorithm>
#include <cmath>
#include <unordered_map>

#include <fmt/format.h>

#include "common/error.hpp"
#include "netem/import/importers.hpp"

namespace thimble {
namespace {

// A rate of the clocks above both limits gets a remark.
constexpr double kNotableDrift = 5e-6, kNotableErrors = 5;
constexpr std::size_t kDriftBlocks = 12, kLeastInBlock = 5;

std::vector<CapturedDatagram> flow_of(const Capture& capture, std::optional<std::uint16_t> port) {
    std::vector<CapturedDatagram> flow;
    for (const CapturedDatagram& datagram : capture.datagrams) {
        if (!port || datagram.to_port == *port) flow.push_back(datagram);
    }
    // Captures of several interfaces are not quite in order.
    std::stable_sort(flow.begin(), flow.end(), [](const CapturedDatagram& a, const CapturedDatagram& b) {
        return a.stamp_ns < b.stamp_ns;
    });
    return flow;
}

std::uint64_t identity(const CapturedDatagram& datagram) {
    return datagram.payload_hash ^ 0x9E3779B97F4A7C15U * (std::uint64_t{datagram.payload_bytes} + 1);
}

class Matcher {
  public:
    Matcher(const Capture& sent, const Capture& received, const CapturePairOptions& options)
        : options_(options),
          sent_(flow_of(sent, options.sent_port)),
          received_(flow_of(received, options.received_port)),
          delays_ns_(sent_.size()) {}

    CapturePair match() {
        pair_up();
        if (pair_.lost == sent_.size()) {
            throw Error(ExitCode::kData,
                        "no datagram of the first capture ({} read) is in the second ({} read): are they of "
                        "the same traffic, and are the ports right?",
                        sent_.size(), received_.size());
        }
        build_path();
        remark();
        return std::move(pair_);
    }

  private:
    struct Equals {
        std::vector<std::size_t> waiting{};  // the first sent at the end
        std::size_t sent = 0;
    };

    void pair_up() {
        std::unordered_map<std::uint64_t, Equals> equals;
        for (std::size_t i = sent_.size(); i-- > 0;) {
            Equals& same = equals[identity(sent_[i])];
            same.waiting.push_back(i);
            ++same.sent;
        }
        std::size_t latest = 0;
        for (const CapturedDatagram& arrival : received_) {
            const auto same = equals.find(identity(arrival));
            if (same == equals.end()) {
                ++pair_.foreign;
            } else if (same->second.waiting.empty()) {
                ++pair_.duplicates;
            } else {
                const std::size_t packet = same->second.waiting.back();
                same->second.waiting.pop_back();
                delays_ns_[packet] = arrival.stamp_ns - sent_[packet].stamp_ns;
                if (packet < latest) ++pair_.reordered;
                latest = std::max(latest, packet);
            }
        }
        pair_.sent = sent_.size();
        pair_.received = received_.size();
        for (const auto& [_, same] : equals) {
            pair_.lost += same.waiting.size();
            if (same.sent > 1 && !same.waiting.empty()) pair_.ambiguous += same.sent;
        }
    }

    void build_path() {
        std::int64_t least = INT64_MAX, most = INT64_MIN;
        for (const auto& delay_ns : delays_ns_) {
            least = std::min(least, delay_ns.value_or(least));
            most = std::max(most, delay_ns.value_or(most));
        }
        pair_.least = Duration{least};
        pair_.most = Duration{most};
        if (least < 0 && !options_.least_delay) {
            throw Error(
                ExitCode::kData,
                "a datagram arrives {:.6f} s before it was sent: the two clocks are not synchronised. Give "
                "the shortest delay with --least-delay-s; then only the variation comes from the captures",
                -to_seconds(pair_.least));
        }
        const std::int64_t shift_ns = options_.least_delay ? options_.least_delay->count() - least : 0;
        if (most - least > kLongestPathDelay.count() || most + shift_ns > kLongestPathDelay.count()) {
            throw Error(ExitCode::kData,
                        "delays of more than a minute: are the two captures of the same traffic?");
        }
        pair_.path.has_delay = pair_.path.has_loss = true;
        for (std::size_t i = 0; i < sent_.size(); ++i) append(i, shift_ns);
    }

    void append(std::size_t packet, std::int64_t shift_ns) {
        MeasuredPacket measured;
        measured.at = sent_[packet].stamp_ns - sent_.front().stamp_ns;
        measured.loss = delays_ns_[packet] ? 0 : 1;
        if (delays_ns_[packet]) measured.delay = Duration{*delays_ns_[packet] + shift_ns};
        pair_.path.append(measured);
        if (pair_.path.packets.back().at > kLongestPath.count())
            throw Error(ExitCode::kData, "a capture of more than 1000 hours");
    }

    void remark() {
        auto& remarks = pair_.path.remarks;
        if (options_.least_delay) {
            remarks.push_back(fmt::format(
                "Delays were shifted by {:.6f} s, so that the shortest is {:.6f} s: clocks that are not "
                "synchronised cannot tell the path's own delay.",
                to_seconds(*options_.least_delay - pair_.least), to_seconds(*options_.least_delay)));
        } else {
            remarks.emplace_back(
                "Delays are differences of two machines' time stamps, and only as good as their clocks "
                "agree. None is below 0, which is necessary but does not prove it.");
        }
        if (const Drift drift = clock_drift(); drift.notable()) {
            remarks.push_back(
                fmt::format("The shortest delay changes by {:+.1f} us per second (standard error {:.1f}): "
                            "the clocks drift, or the path changes.",
                            1e6 * drift.rate, 1e6 * drift.error));
        }
        if (pair_.ambiguous > 0) {
            remarks.push_back(
                fmt::format("{} datagrams have payloads that were sent several times and not always "
                            "received: it is a guess which of them was lost.",
                            pair_.ambiguous));
        }
    }

    struct Drift {
        double rate = 0, error = 0;  // both without a unit
        bool notable() const {
            return std::abs(rate) > kNotableDrift && std::abs(rate) > kNotableErrors * error;
        }
    };

    // The line through the quickest packets of equal blocks. Jitter alone moves the least delay of a block, so one clock has a
    // slope, too. The distances of the packets from the line give the error of that slope.
    Drift clock_drift() const {
        const auto& packets = pair_.path.packets;
        const std::size_t size = packets.size() / kDriftBlocks;
        if (size < kLeastInBlock) return {};
        const auto quicker = [](const MeasuredPacket& a, const MeasuredPacket& b) {
            return a.delay.value_or(Duration::max()) < b.delay.value_or(Duration::max());
        };
        std::vector<MeasuredPacket> quickest;
        quickest.reserve(kDriftBlocks);
        for (std::size_t i = 0; i < kDriftBlocks; ++i) {
            const auto first = packets.begin() + static_cast<std::ptrdiff_t>(i * size);
            const auto found = std::min_element(first, first + static_cast<std::ptrdiff_t>(size), quicker);
            if (found->delay) quickest.push_back(*found);
        }
        return slope_of(quickest);
    }

    static Drift slope_of(const std::vector<MeasuredPacket>& points) {
        if (points.size() < 3) return {};
        const auto n = static_cast<double>(points.size());
        double mean_x = 0, mean_y = 0, xx = 0, xy = 0, yy = 0;
        for (const MeasuredPacket& point : points) {
            mean_x += static_cast<double>(point.at) / n;
            mean_y += static_cast<double>(point.delay->count()) / n;
        }
        for (const MeasuredPacket& point : points) {
            const double x = static_cast<double>(point.at) - mean_x;
            const double y = static_cast<double>(point.delay->count()) - mean_y;
            xx += x * x;
            xy += x * y;
            yy += y * y;
        }
        if (xx <= 0) return {};
        const double rate = xy / xx;
        return {rate, std::sqrt(std::max(0.0, yy - rate * xy) / (n - 2) / xx)};
    }

    const CapturePairOptions& options_;
    std::vector<CapturedDatagram> sent_, received_;
    std::vector<std::optional<std::int64_t>> delays_ns_;  // of each sent; none: lost
    CapturePair pair_;
};

}  // namespace

CapturePair match_captures(const Capture& sent, const Capture& received, const CapturePairOptions& options) {
    return Matcher(sent, received, options).match();
}

}  // namespace thimble
