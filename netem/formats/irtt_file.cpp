#include "netem/formats/irtt_file.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/error.hpp"

namespace thimble {
namespace {

using Json = nlohmann::json;

// A remark is due where half of the difference between the two means is more than this share of the round trip.
constexpr double kSuspiciousAsymmetry = 0.25;

class IrttParser {
  public:
    explicit IrttParser(std::string_view name) : name_(name) {}

    MeasuredPaths parse(std::string_view text) {
        const Json json = Json::parse(text, nullptr, false);
        if (json.is_discarded())
            fail("is not JSON; irtt writes .json.gz unless FILE ends in .json: unpack it");
        const Json* trips = member(json, "round_trips");
        if (trips == nullptr || !trips->is_array() || trips->empty()) {
            fail("has no list \"round_trips\"; was it written by `irtt client -o`?");
        }
        if (trips->size() > kMostPackets) fail(fmt::format("has more than {} round trips", kMostPackets));
        one_way_ =
            std::all_of(trips->begin(), trips->end(), [](const Json& trip) { return has_stamps(trip); });
        for (const Json& trip : *trips) read_trip(trip);
        remark();
        return std::move(paths_);
    }

  private:
    [[noreturn]] void fail(const std::string& why) const {
        throw Error(ExitCode::kData, fmt::format("{}: {}", name_, why));
    }
    static const Json* member(const Json& json, const char* key) {
        const auto found = json.is_object() ? json.find(key) : json.end();
        return found == json.end() ? nullptr : &*found;
    }
    static std::optional<std::int64_t> nanoseconds(const Json* json) {
        if (json == nullptr || !json->is_number_integer()) return {};
        return json->get<std::int64_t>();
    }
    static std::optional<std::int64_t> delay_of(const Json& trip, const char* key) {
        const Json* delays = member(trip, "delay");
        return delays == nullptr ? std::nullopt : nanoseconds(member(*delays, key));
    }
    // "lost" is true or false, or since the server can tell the direction a text, "true_up" or "true_down".
    static std::string lost_of(const Json& trip) {
        const Json* lost = member(trip, "lost");
        if (lost == nullptr) return "";
        if (lost->is_boolean()) return lost->get<bool>() ? "true" : "false";
        return lost->is_string() ? lost->get<std::string>() : "";
    }
    static bool has_stamps(const Json& trip) {
        return lost_of(trip) != "false" || (delay_of(trip, "send") && delay_of(trip, "receive"));
    }

    std::int64_t sent_at(const Json& trip, std::size_t entry) const {
        const Json* at = member(trip, "timestamps");
        for (const char* key : {"client", "send"}) at = at == nullptr ? nullptr : member(*at, key);
        if (at != nullptr) {
            for (const char* clock : {"monotonic", "wall"}) {
                if (const auto stamp = nanoseconds(member(*at, clock))) return *stamp;
            }
        }
        fail(fmt::format("round_trips[{}] has no timestamps.client.send", entry));
    }

    std::optional<Duration> checked(std::optional<std::int64_t> delay_ns, std::size_t entry) const {
        if (!delay_ns) fail(fmt::format("round_trips[{}] is not lost, but has no delay", entry));
        if (*delay_ns < 0) {
            fail(fmt::format(
                "round_trips[{}] arrived {} ns before it was sent: the two clocks disagree; measure with "
                "synchronised clocks, or with --tstamp=none to take halves of the round trip",
                entry, -*delay_ns));
        }
        if (Duration{*delay_ns} > kLongestPathDelay) {
            fail(fmt::format("round_trips[{}] took {} ns, more than a minute", entry, *delay_ns));
        }
        return Duration{*delay_ns};
    }

    void read_trip(const Json& trip) {
        const std::size_t entry = paths_.up.packets.size();
        const std::string lost = lost_of(trip);
        if (lost != "false" && lost != "true" && lost != "true_up" && lost != "true_down") {
            fail(fmt::format("round_trips[{}].lost is none of false, true, true_up, true_down", entry));
        }
        const std::int64_t sent = sent_at(trip, entry);
        if (entry == 0) start_ = sent;
        const bool in_order = paths_.up.packets.empty() || sent - start_ > paths_.up.packets.back().at;
        if (!in_order || sent - start_ > kLongestPath.count()) {
            fail(fmt::format("round_trips[{}] was not sent after the one before it", entry));
        }
        MeasuredPacket up{sent - start_, {}, 0, 0};
        MeasuredPacket down = up;
        if (lost == "false") {
            const auto half = delay_of(trip, "rtt");
            up.delay = checked(one_way_ ? delay_of(trip, "send")
                               : half   ? std::optional(*half / 2)
                                        : half,
                               entry);
            down.delay = checked(one_way_ ? delay_of(trip, "receive")
                                 : half   ? std::optional(*half / 2)
                                          : half,
                                 entry);
        } else {
            (lost == "true_down" ? down : up).loss = 1;
            unclear_ += lost == "true" ? 1 : 0;
        }
        // A packet lost on its way up was never sent down, so it says nothing about that direction.
        paths_.up.packets.push_back(up);
        if (lost == "false" || lost == "true_down") paths_.down.packets.push_back(down);
    }

    void remark() {
        for (MeasuredPath* path : {&paths_.up, &paths_.down}) {
            path->has_delay = path->has_loss = true;
            if (!one_way_) {
                path->remarks.push_back(
                    "Each delay is half of a round trip: irtt had no stamps of the server, so the directions "
                    "cannot be "
                    "told apart.");
            } else if (asymmetry() > kSuspiciousAsymmetry) {
                path->remarks.push_back(
                    fmt::format("The mean delays of the two directions differ by {:.0f} % of the round trip: "
                                "either the path is "
                                "asymmetric, or the two clocks are not synchronised, which these stamps "
                                "cannot tell apart.",
                                200 * asymmetry()));
            } else {
                path->remarks.push_back(
                    "Delays are one-way by the stamps of both machines and no better than their clocks "
                    "agree.");
            }
            if (unclear_ > 0) {
                path->remarks.push_back(
                    fmt::format("{} losses of unknown direction count as lost upwards.", unclear_));
            }
        }
        drop_delays_of_unanswered();
    }
    // A packet whose answer was lost reached the server at an unknown time.
    void drop_delays_of_unanswered() {
        auto& packets = paths_.up.packets;
        packets.erase(std::remove_if(packets.begin(), packets.end(),
                                     [](const MeasuredPacket& p) { return p.loss == 0 && !p.delay; }),
                      packets.end());
        if (paths_.down.packets.empty())
            fail("no packet reached the server: there is no way down to speak of");
        if (packets.empty()) fail("no packet was answered: there is nothing to say about the way up");
    }
    static double mean_ns(const MeasuredPath& path) {
        double sum_ns = 0, count = 0;
        for (const MeasuredPacket& packet : path.packets) {
            if (!packet.delay) continue;
            sum_ns += static_cast<double>(packet.delay->count());
            ++count;
        }
        return count > 0 ? sum_ns / count : 0;
    }
    double asymmetry() const {
        const double up_ns = mean_ns(paths_.up), down_ns = mean_ns(paths_.down);
        const double round_trip_ns = up_ns + down_ns;
        return round_trip_ns > 0 ? std::abs(up_ns - down_ns) / 2 / round_trip_ns : 0;
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
