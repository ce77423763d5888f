#include "netem/formats/capture_pair.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include <fmt/format.h>

#include "common/error.hpp"

namespace thimble {
namespace {

// Where the clocks run apart by more than this, a remark says so.
constexpr double kNotableDrift = 5e-6;

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
          arrival_(sent_.size(), kLost) {}

    CapturePair match() {
        pair_up();
        if (pair_.lost == sent_.size()) {
            throw Error(
                ExitCode::kData,
                fmt::format(
                    "no datagram of the first capture ({} looked at) is in the second ({} looked at): "
                    "are they of the same traffic, and are the ports right?",
                    sent_.size(), received_.size()));
        }
        count_ambiguous();
        build_path();
        remark();
        return std::move(pair_);
    }

  private:
    static constexpr std::size_t kLost = SIZE_MAX;

    void pair_up() {
        std::unordered_map<std::uint64_t, std::vector<std::size_t>> waiting;  // the latest sent in front
        for (std::size_t i = sent_.size(); i-- > 0;) waiting[identity(sent_[i])].push_back(i);
        std::size_t latest = 0;
        bool any = false;
        for (std::size_t i = 0; i < received_.size(); ++i) {
            const auto same = waiting.find(identity(received_[i]));
            if (same == waiting.end()) {
                ++pair_.foreign;
            } else if (same->second.empty()) {
                ++pair_.duplicates;
            } else {
                const std::size_t packet = same->second.back();
                same->second.pop_back();
                arrival_[packet] = i;
                if (any && packet < latest) ++pair_.reordered;
                latest = any ? std::max(latest, packet) : packet;
                any = true;
            }
        }
        pair_.sent = sent_.size();
        pair_.received = received_.size();
        pair_.lost = static_cast<std::size_t>(std::count(arrival_.begin(), arrival_.end(), kLost));
    }

    void count_ambiguous() {
        struct Copies {
            std::size_t sent = 0, lost = 0;
        };
        std::unordered_map<std::uint64_t, Copies> copies;
        for (std::size_t i = 0; i < sent_.size(); ++i) {
            Copies& of_this = copies[identity(sent_[i])];
            ++of_this.sent;
            of_this.lost += arrival_[i] == kLost ? 1 : 0;
        }
        for (const auto& [_, count] : copies) {
            if (count.sent > 1 && count.lost > 0) pair_.ambiguous += count.sent;
        }
    }

    std::int64_t raw_delay_ns(std::size_t packet) const {
        return received_[arrival_[packet]].stamp_ns - sent_[packet].stamp_ns;
    }

    void build_path() {
        std::int64_t least = INT64_MAX, most = INT64_MIN;
        for (std::size_t i = 0; i < sent_.size(); ++i) {
            if (arrival_[i] == kLost) continue;
            least = std::min(least, raw_delay_ns(i));
            most = std::max(most, raw_delay_ns(i));
        }
        pair_.least = Duration{least};
        pair_.most = Duration{most};
        if (least < 0 && !options_.least_delay) {
            throw Error(
                ExitCode::kData,
                fmt::format(
                    "a datagram arrives {:.6f} s before it was sent: the two clocks are not "
                    "synchronised. Say what the least delay should be (--least-delay-s), and only the "
                    "variation is taken from the captures",
                    -to_seconds(pair_.least)));
        }
        const std::int64_t shift = options_.least_delay ? options_.least_delay->count() - least : 0;
        if (most - least > kLongestPathDelay.count() || most + shift > kLongestPathDelay.count()) {
            throw Error(ExitCode::kData,
                        "delays of more than a minute: are the two captures of the same traffic?");
        }
        pair_.path.has_delay = pair_.path.has_loss = true;
        for (std::size_t i = 0; i < sent_.size(); ++i) append(i, shift);
    }

    void append(std::size_t packet, std::int64_t shift_ns) {
        MeasuredPacket measured;
        measured.at = sent_[packet].stamp_ns - sent_.front().stamp_ns;
        auto& packets = pair_.path.packets;
        if (!packets.empty()) measured.at = std::max(measured.at, packets.back().at + 1);  // equal stamps
        if (measured.at > kLongestPath.count())
            throw Error(ExitCode::kData, "a capture of more than 1000 hours");
        measured.loss = arrival_[packet] == kLost ? 1 : 0;
        if (arrival_[packet] != kLost) measured.delay = Duration{raw_delay_ns(packet) + shift_ns};
        packets.push_back(measured);
    }

    void remark() {
        auto& remarks = pair_.path.remarks;
        if (options_.least_delay) {
            remarks.push_back(fmt::format(
                "Delays were moved by {:.6f} s, so that the least is {:.6f} s: what the path "
                "really takes is not known from clocks that are not synchronised.",
                to_seconds(*options_.least_delay - pair_.least), to_seconds(*options_.least_delay)));
        } else {
            remarks.push_back(
                "Delays are differences of two machines' stamps and no better than their clocks agree; none "
                "is below "
                "0, which is necessary, not sufficient.");
        }
        if (const double drift = clock_drift(); std::abs(drift) > kNotableDrift) {
            remarks.push_back(fmt::format(
                "The least delay moves by {:+.1f} us per second: the clocks run apart, or the path changes.",
                1e6 * drift));
        }
        if (pair_.ambiguous > 0) {
            remarks.push_back(
                fmt::format("{} datagrams have payloads that were sent several times and not always "
                            "received: which of them was lost is a guess.",
                            pair_.ambiguous));
        }
    }

    // Between the quickest packets of the first and of the last third.
    double clock_drift() const {
        const auto& packets = pair_.path.packets;
        if (packets.size() < 30) return 0;
        const auto quickest = [&](std::size_t from, std::size_t to) {
            const MeasuredPacket* least = nullptr;
            for (std::size_t i = from; i < to; ++i) {
                if (packets[i].delay && (least == nullptr || *packets[i].delay < *least->delay))
                    least = &packets[i];
            }
            return least;
        };
        const MeasuredPacket* early = quickest(0, packets.size() / 3);
        const MeasuredPacket* late = quickest(packets.size() - packets.size() / 3, packets.size());
        if (early == nullptr || late == nullptr) return 0;
        return static_cast<double>((*late->delay - *early->delay).count()) /
               static_cast<double>(late->at - early->at);
    }

    const CapturePairOptions& options_;
    std::vector<CapturedDatagram> sent_, received_;
    std::vector<std::size_t> arrival_;  // place in received_, of each sent
    CapturePair pair_;
};

}  // namespace

CapturePair match_captures(const Capture& sent, const Capture& received, const CapturePairOptions& options) {
    return Matcher(sent, received, options).match();
}

}  // namespace thimble
