#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include <fmt/format.h>

#include "common/decimal_text.hpp"
#include "netem/formats/text_lines.hpp"
#include "netem/import/importers.hpp"

namespace thimble {
namespace {

constexpr std::int64_t kNumbers = 65536;  // icmp_seq has 16 bits and begins again
constexpr std::int64_t kLongestGap = 10'000;

struct Reply {
    std::int64_t number = 0;
    double stamp_s = 0, round_trip_s = 0;
};

// The number behind `key`, as in "icmp_seq=3 ".
std::optional<double> number_after(std::string_view line, std::string_view key) {
    const std::size_t at = line.find(key);
    if (at == std::string_view::npos) return {};
    std::string_view rest = line.substr(at + key.size());
    return parse_number(rest.substr(0, rest.find_first_not_of("0123456789.")));
}

// Time at which the line was printed, s; 0 without -D.
double stamp_s_of(std::string_view line) {
    return line.starts_with('[') ? number_after(line, "[").value_or(0) : 0;
}

class PingParser {
  public:
    PingParser(std::string_view text, std::string_view name, Duration interval)
        : lines_(text, name), name_(name), interval_s_(to_seconds(interval)) {}

    MeasuredPath parse() {
        while (lines_.next()) read_line(lines_.line());
        if (replies_.empty()) {
            fail_at_line(name_, std::max<std::size_t>(1, lines_.number()),
                         "no line like \"64 bytes from ...: icmp_seq=1 ttl=64 time=0.5 ms\": is this ping's "
                         "output in English (LC_ALL=C)?");
        }
        build();
        return std::move(path_);
    }

  private:
    void read_line(std::string_view line) {
        if (line.find("packets transmitted") != std::string_view::npos) {
            const double sent = number_after(line, "").value_or(0);
            if (sent > kMostPackets) lines_.fail("more than {} packets", kMostPackets);
            sent_ = static_cast<std::int64_t>(sent);
            return;
        }
        const auto number =
            number_after(line, line.find("icmp_seq=") != std::string_view::npos ? "icmp_seq=" : " seq=");
        const auto time = number_after(line, " time=");
        if (!number || !time)
            return;  // headings, "no answer yet", "Destination Host Unreachable", the summary
        if (*number >= kNumbers || *time > 120e3) lines_.fail("a number or a time that no ping prints");
        if (line.find("DUP!") != std::string_view::npos) {
            ++duplicates_;
            return;
        }
        add({unwrapped(static_cast<std::int64_t>(*number)), stamp_s_of(line), *time * 1e-3});
    }

    // The number nearest to the last that has these 16 bits.
    std::int64_t unwrapped(std::int64_t number) const {
        if (replies_.empty()) return number;
        const std::int64_t base = last_ - last_ % kNumbers;
        std::int64_t best = base + number;
        for (const std::int64_t other : {best - kNumbers, best + kNumbers}) {
            if (other >= 0 && std::abs(other - last_) < std::abs(best - last_)) best = other;
        }
        return best;
    }

    void add(const Reply& reply) {
        if (!replies_.empty() && reply.number - last_ > kLongestGap)
            lines_.fail("too many packets missing here");
        if (replies_.size() == kMostPackets) lines_.fail("more than {} replies", kMostPackets);
        if (!replies_.emplace(reply.number, reply).second) {
            ++duplicates_;  // BSD does not mark them
            return;
        }
        late_ += reply.number < last_ ? 1 : 0;
        last_ = std::max(last_, reply.number);
    }

    // The first number is 1 with iputils, 0 elsewhere; a first packet that was lost leaves no line.
    void build() {
        const std::int64_t first = std::min<std::int64_t>(replies_.begin()->first, 1);
        if (sent_ - last_ > kLongestGap)
            lines_.fail("{} packets were sent, and there is no reply after packet {}: too many are missing",
                        sent_, last_);
        const std::int64_t end = std::max(last_ + 1, first + sent_);
        read_stamps(first);
        for (std::int64_t number = first; number < end; ++number) append(number, first);
        remark();
    }

    // When packets were sent, from the stamps of their replies. Without any they stand at the interval.
    void read_stamps(std::int64_t first) {
        for (const auto& [number, reply] : replies_) {
            if (reply.stamp_s > 0)
                sent_s_.emplace_hint(sent_s_.end(), number, reply.stamp_s - reply.round_trip_s);
        }
        stamped_ = !sent_s_.empty();
        if (!stamped_) sent_s_.emplace(first, 0);
        const auto& [first_number, first_s] = *sent_s_.begin();
        const auto& [last_number, last_s] = *sent_s_.rbegin();
        if (last_number > first_number && last_s > first_s)
            interval_s_ = (last_s - first_s) / static_cast<double>(last_number - first_number);
    }

    // A packet without a stamp stands on the straight line between its neighbours, or at the mean interval beyond them.
    double sent_s(std::int64_t number) const {
        const auto after = sent_s_.lower_bound(number);
        if (after == sent_s_.end())
            return sent_s_.rbegin()->second +
                   static_cast<double>(number - sent_s_.rbegin()->first) * interval_s_;
        if (after->first == number) return after->second;
        if (after == sent_s_.begin())
            return after->second - static_cast<double>(after->first - number) * interval_s_;
        const auto before = std::prev(after);
        return before->second + (after->second - before->second) *
                                    static_cast<double>(number - before->first) /
                                    static_cast<double>(after->first - before->first);
    }

    void append(std::int64_t number, std::int64_t first) {
        const auto reply = replies_.find(number);
        const double since_first_s = sent_s(number) - sent_s(first);
        MeasuredPacket packet{.at = std::llround(std::max(0.0, std::min(since_first_s, 3.6e6)) * 1e9),
                              .loss = 1};
        if (reply != replies_.end()) {
            packet.delay = from_seconds(reply->second.round_trip_s / 2);
            packet.loss = 0;
        }
        path_.append(packet);
    }

    void remark() {
        path_.has_delay = path_.has_loss = true;
        path_.remarks.push_back(
            "Each delay is half of a round trip, and each loss may be on either way: ping cannot separate "
            "the directions.");
        path_.remarks.emplace_back(
            "A network with these losses both ways loses twice as many: halve `loss` in [up] and [down] of a "
            "profile.");
        if (!stamped_) {
            path_.remarks.push_back(fmt::format(
                "Lines have no time stamps (ping -D), so packets are assumed {} s apart.", interval_s_));
        }
        if (duplicates_ > 0)
            path_.remarks.push_back(fmt::format("{} duplicates were left out.", duplicates_));
        if (late_ > 0) path_.remarks.push_back(fmt::format("{} replies came out of order.", late_));
    }

    LineReader lines_;
    std::string_view name_;
    double interval_s_;
    std::map<std::int64_t, Reply> replies_;
    std::map<std::int64_t, double> sent_s_;  // of those with a stamp
    std::int64_t last_ = 0, sent_ = 0;
    std::size_t duplicates_ = 0, late_ = 0;
    bool stamped_ = false;
    MeasuredPath path_;
};

}  // namespace

MeasuredPath parse_ping(std::string_view text, std::string_view name, Duration interval) {
    return PingParser(text, name, interval).parse();
}

}  // namespace thimble
