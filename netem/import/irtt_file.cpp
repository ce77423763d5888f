#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "netem/import/importers.hpp"

namespace thimble {
namespace {

using Json = nlohmann::json;

// A remark is due where half of the difference between the two means is more than this share of the round trip.
constexpr double kSuspiciousAsymmetry = 0.25;

std::optional<std::int64_t> nanoseconds_at(const Json& json, const char* place) {
    const Json::json_pointer pointer(place);
    if (!json.contains(pointer) || !json.at(pointer).is_number_integer()) return {};
    return json.at(pointer).get<std::int64_t>();
}

// "lost" is true or false, or since the server can tell the direction a text, "true_up" or "true_down".
std::string lost_of(const Json& trip) {
    const Json lost = trip.is_object() ? trip.value("lost", Json()) : Json();
    if (lost.is_boolean()) return lost.get<bool>() ? "true" : "false";
    return lost.is_string() ? lost.get<std::string>() : "";
}

bool has_stamps(const Json& trip) {
    return lost_of(trip) != "false" ||
           (nanoseconds_at(trip, "/delay/send") && nanoseconds_at(trip, "/delay/receive"));
}

double mean_ns(const MeasuredPath& path) {
    double sum_ns = 0, count = 0;
    for (const MeasuredPacket& packet : path.packets) {
        if (!packet.delay) continue;
        sum_ns += static_cast<double>(packet.delay->count());
        ++count;
    }
    return count > 0 ? sum_ns / count : 0;
}

class IrttParser {
  public:
    explicit IrttParser(std::string_view name) : name_(name) {}

    MeasuredPaths parse(std::string_view text) {
        const Json json = Json::parse(text, nullptr, false);
        if (json.is_discarded())
            fail("is not JSON; irtt writes .json.gz unless FILE ends in .json: unpack it");
        const Json none;
        const Json& trips = json.contains("round_trips") ? json.at("round_trips") : none;
        if (!trips.is_array() || trips.empty()) {
            fail("has no list \"round_trips\"; was it written by `irtt client -o`?");
        }
        if (trips.size() > kMostPackets) fail(fmt::format("has more than {} round trips", kMostPackets));
        one_way_ = std::all_of(trips.begin(), trips.end(), has_stamps);
        for (const Json& trip : trips) read_trip(trip);
        remark();
        drop_delays_of_unanswered();
        return std::move(paths_);
    }

  private:
    [[noreturn]] void fail(const std::string& why) const {
        throw Error(ExitCode::kData, "{}: {}", name_, why);
    }
    [[noreturn]] void fail_here(const std::string& why) const {
        fail(fmt::format("round_trips[{}]{}", paths_.up.packets.size(), why));
    }

    std::int64_t sent_at(const Json& trip) const {
        for (const char* clock : {"/timestamps/client/send/monotonic", "/timestamps/client/send/wall"}) {
            if (const auto stamp = nanoseconds_at(trip, clock)) return *stamp;
        }
        fail_here(" has no timestamps.client.send");
    }

    Duration delay_of(const Json& trip, const char* one_way) const {
        auto delay_ns = nanoseconds_at(trip, one_way_ ? one_way : "/delay/rtt");
        if (!delay_ns) fail_here(" is not lost, but has no delay");
        if (!one_way_) *delay_ns /= 2;
        if (*delay_ns < 0) {
            fail_here(
                fmt::format(" arrived {} ns before it was sent: the two clocks disagree; measure with "
                            "synchronised clocks, or with --tstamp=none to take halves of the round trip",
                            -*delay_ns));
        }
        if (Duration{*delay_ns} > kLongestPathDelay) {
            fail_here(fmt::format(" took {} ns, more than a minute", *delay_ns));
        }
        return Duration{*delay_ns};
    }

    void read_trip(const Json& trip) {
        auto& sent_up = paths_.up.packets;
        const std::string lost = lost_of(trip);
        if (lost != "false" && lost != "true" && lost != "true_up" && lost != "true_down") {
            fail_here(".lost is not false, true, true_up or true_down");
        }
        const std::int64_t sent = sent_at(trip);
        if (sent_up.empty()) start_ = sent;
        MeasuredPacket up{.at = sent - start_};
        if ((!sent_up.empty() && up.at <= sent_up.back().at) || up.at > kLongestPath.count()) {
            fail_here(" was not sent after the one before it");
        }
        MeasuredPacket down = up;
        if (lost == "false") {
            up.delay = delay_of(trip, "/delay/send");
            down.delay = delay_of(trip, "/delay/receive");
        } else {
            (lost == "true_down" ? down : up).loss = 1;
            unclear_ += lost == "true" ? 1 : 0;
        }
        // A packet lost on its way up was never sent down, so it says nothing about that direction.
        sent_up.push_back(up);
        if (lost == "false" || lost == "true_down") paths_.down.packets.push_back(down);
    }

    std::string remark_on_clocks() const {
        const double up_ns = mean_ns(paths_.up), down_ns = mean_ns(paths_.down);
        const double difference = up_ns + down_ns > 0 ? std::abs(up_ns - down_ns) / (up_ns + down_ns) : 0;
        if (!one_way_) {
            return "Each delay is half of a round trip: irtt had no time stamps of the server, so the "
                   "directions cannot be separated.";
        }
        if (difference > 2 * kSuspiciousAsymmetry) {
            return fmt::format(
                "The mean delays of the two directions differ by {:.0f} % of the round trip: either the path "
                "is asymmetric, or the two clocks are not synchronised, which these stamps cannot tell "
                "apart.",
                100 * difference);
        }
        return "Delays are one-way, from the time stamps of both machines, and only as good as their clocks "
               "agree.";
    }

    void remark() {
        const std::string on_clocks = remark_on_clocks();
        for (MeasuredPath* path : {&paths_.up, &paths_.down}) {
            path->has_delay = path->has_loss = true;
            path->remarks.push_back(on_clocks);
            if (unclear_ == 0) continue;
            path->remarks.push_back(
                fmt::format("{} losses of unknown direction count as lost on the way up.", unclear_));
        }
    }
    // A packet whose answer was lost reached the server at an unknown time.
    void drop_delays_of_unanswered() {
        auto& packets = paths_.up.packets;
        std::erase_if(packets, [](const MeasuredPacket& p) { return p.loss == 0 && !p.delay; });
        if (paths_.down.packets.empty())
            fail("no packet reached the server: there are no data about the way down");
        if (packets.empty()) fail("no packet was answered: there are no data about the way up");
    }

    std::string_view name_;
    MeasuredPaths paths_;
    bool one_way_ = false;
    std::int64_t start_ = 0;
    std::size_t unclear_ = 0;
};

}  // namespace

MeasuredPaths parse_irtt(std::string_view text, std::string_view name) {
    return IrttParser(name).parse(text);
}

}  // namespace thimble
