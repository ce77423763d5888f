#include "netem/relay/selftest.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <cmath>
#include <map>
#include <optional>

#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/runtime/event_waiter.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/wall_clock.hpp"
#include "netem/delivery_trace.hpp"
#include "netem/packet_trace.hpp"
#include "netem/relay/loss_law.hpp"
#include "netem/relay/relay_engine.hpp"
#include "netem/relay/relay_service.hpp"
#include "netem/relay/selftest_traffic.hpp"

namespace thimble {
namespace {

// Time for the last packets beyond what the links take: stalls of the machine.
constexpr Duration kSettling = std::chrono::milliseconds{300};
constexpr Duration kPathStopLatency = std::chrono::milliseconds{100};  // of a path that waits

constexpr Duration kLongToWait = std::chrono::seconds{5};
constexpr double kLongestDrain_s = 600;

Duration bare_part(const SelftestSettings& settings) { return settings.length / 10; }

// Keeps as many records as there is room for.
class Records final : public PacketSink {
  public:
    explicit Records(std::size_t room) { records_.reserve(room); }
    void add(const PacketRecord& record) override {
        if (records_.size() < records_.capacity()) records_.push_back(record);
    }
    // Of one direction, by packet, one each: a packet that was sent and whose second copy was dropped counts as sent.
    std::vector<PacketRecord> of(RelayDirection direction) const {
        std::map<std::uint64_t, PacketRecord> chosen;
        for (const PacketRecord& record : records_) {
            if (record.direction != direction || record.copy) continue;
            const auto [kept, fresh] = chosen.emplace(record.packet, record);
            if (!fresh && record.fate < kept->second.fate) kept->second = record;
        }
        std::vector<PacketRecord> records;
        records.reserve(chosen.size());
        for (const auto& [_, record] : chosen) records.push_back(record);
        return records;
    }

  private:
    std::vector<PacketRecord> records_;
};

std::size_t packets_of(const SelftestSettings& settings) {
    return static_cast<std::size_t>((settings.length - 2 * bare_part(settings)) / kTrafficPeriod);
}

// The lowest rate that a link may have; 0: no limit.
double slowest_bits_per_s(const LinkSettings& link) {
    double slowest = link.rate.bits_per_s > 0 ? link.rate.bits_per_s : HUGE_VAL;
    if (link.trace != nullptr && link.trace->layout().has_rate) {
        for (const TraceRow& row : link.trace->rows()) slowest = std::min(slowest, row.bits_per_s);
    }
    if (link.deliveries != nullptr)  // its mean
        slowest = std::min(slowest, 8.0 * DeliveryTrace::kBytesPerOpportunity *
                                        static_cast<double>(link.deliveries->times_ms().size()) /
                                        to_seconds(link.deliveries->period()));
    return slowest < HUGE_VAL ? slowest : 0;
}

// How long a link with a rate still sends after so many packets of `bytes`: what it is behind, or what it holds.
double queue_s(const LinkSettings& link, std::size_t packets, std::size_t bytes) {
    const RateSettings& rate = link.rate;
    const double bits_per_s = slowest_bits_per_s(link);
    if (bits_per_s == 0) return 0;
    const double each_s = 8.0 * static_cast<double>(rate.bytes_on_air(bytes)) / bits_per_s;
    std::size_t held = link.capacity;
    if (rate.queue_packets > 0) held = std::min(held, rate.queue_packets + 1);
    if (rate.queue_bytes > 0) held = std::min(held, rate.queue_bytes / bytes + 1);
    const double behind_s = (link.duplicate > 0 ? 2 : 1) * each_s - to_seconds(kTrafficPeriod);
    // The longest gap between two opportunities may come last.
    const double gap_s = link.deliveries != nullptr ? to_seconds(link.deliveries->period()) : 0;
    return gap_s + std::min(static_cast<double>(held) * each_s,
                            static_cast<double>(packets) * std::max(0.0, behind_s));
}

// Of the slowest settings that a way has during the test.
double way_s(const LinkSettings& first, const Timeline& timeline, Duration length, std::size_t packets,
             std::size_t bytes) {
    const auto last_packet_s = [&](const LinkSettings& link) {
        return to_seconds(nearly_longest_delay(link)) + queue_s(link, packets, bytes);
    };
    double longest_s = last_packet_s(first);
    for (const LinkChange& change : timeline)
        if (change.at < length) longest_s = std::max(longest_s, last_packet_s(change.settings));
    return longest_s;
}

void say_if_long(Duration drain) {
    if (drain < kLongToWait) return;
    spdlog::info("the test ends {:.0f} s after its last packet: this network may hold packets for so long",
                 to_seconds(drain));
}

class RelayPath final : public SelftestPath {
  public:
    int server() const override { return server_.descriptor(); }
    int client() override { return client_.descriptor(); }
    void open(const SelftestSettings& settings, bool precise, PacketSink& records) override {
        engine_.emplace(RelaySettings{.inlets = {{loopback(), server_.local()}},
                                      .links = settings.links,
                                      .timelines = settings.timelines,
                                      .seed = settings.seed,
                                      .most_flows = 1,
                                      .idle = std::chrono::hours{24},
                                      .precise = precise},
                        &records);
        client_ = UdpSocket::connected(engine_->inlet_address(0));
    }
    void step(SessionTime latest) override { engine_->step(latest); }
    RelayState state(SessionTime now) const override { return engine_->state(now); }
    SessionTime start() const override { return engine_->start(); }
    SessionTime opened(SessionTime first_packet) const override { return first_packet; }

  private:
    static UdpAddress loopback() { return {htonl(INADDR_LOOPBACK), 0}; }
    UdpSocket server_ = UdpSocket::listening(loopback()), client_;
    std::optional<RelayEngine> engine_;
};

std::vector<SessionTime> receptions(const std::vector<PacketRecord>& records) {
    std::vector<SessionTime> received;
    received.reserve(records.size());
    for (const PacketRecord& record : records) received.push_back(from_nanoseconds(record.received_ns));
    return received;
}

void count_records(const std::vector<PacketRecord>& records, const std::vector<bool>& foretold,
                   SelftestDirection& d) {
    for (const PacketRecord& record : records) {
        const bool sent = record.fate == LoggedFate::kSent;
        const bool dropped = !sent && record.fate != LoggedFate::kRefused;
        d.dropped += dropped ? 1U : 0U;
        d.lost += record.fate == LoggedFate::kLost ? 1U : 0U;
        d.corrupted += !dropped && record.corrupted ? 1U : 0U;
        d.early += sent && record.sent_ns < record.due_ns ? 1U : 0U;
        d.other_fates += record.packet >= foretold.size() || foretold[record.packet] != dropped ? 1U : 0U;
    }
}

SelftestDirection examine(const TwinLink& link, std::size_t bytes, const TrafficWay& way,
                          const std::vector<PacketRecord>& records, bool drops_corrupted) {
    SelftestDirection d;
    const std::vector<SessionTime> received = receptions(records);
    d.delays_s = way.delays_s();
    d.offered = way.sent.size();
    d.received = records.size();
    d.arrived = d.delays_s.size();
    count_records(records, replay(link, received, bytes).dropped_packet, d);
    const std::uint64_t accounted = d.arrived + d.dropped + (drops_corrupted ? d.corrupted : way.strangers);
    d.lost_by_machine = d.offered - std::min(d.offered, accounted);
    d.comparison = compare(link, received, bytes, d.delays_s);
    const LossLaw law(link, received);
    d.lost_mean = law.mean();
    d.lost_chance = law.chance_of(d.lost);
    std::sort(d.delays_s.begin(), d.delays_s.end());
    return d;
}

}  // namespace

std::unique_ptr<SelftestPath> make_relay_path() { return std::make_unique<RelayPath>(); }

Duration selftest_drain(const SelftestSettings& settings, std::size_t header_bytes) {
    const std::size_t packets = packets_of(settings);
    const double ways_s =
        way_s(settings.links.up, settings.timelines.up, settings.length, packets, kUpBytes + header_bytes) +
        way_s(settings.links.down, settings.timelines.down, settings.length, packets,
              kDownBytes + header_bytes);
    if (ways_s > kLongestDrain_s) {
        throw Error(ExitCode::kUsage,
                    "self-test: this network may hold packets for {:.0f} s, longer than {} s: give a smaller "
                    "--seconds or capacity, or a higher rate",
                    ways_s, kLongestDrain_s);
    }
    return from_seconds(ways_s) + kSettling;
}

SelftestResult run_selftest(const SelftestSettings& settings, SelftestPath& path) {
    const Duration bare = bare_part(settings), drain = selftest_drain(settings, path.header_bytes());
    install_stop_signals();
    say_if_long(drain);
    const std::size_t packets = packets_of(settings);
    SelftestTraffic traffic(packets, drain, path.server());
    traffic.launch();
    Records records(8 * packets + 16);
    const bool precise = ask_for_precision(settings.runtime, settings.precise);
    SelftestResult result;
    result.timer = measure_timer(kTrafficPeriod, bare);
    path.open(settings, precise, records);
    traffic.start(path.client());
    while (!traffic.finished() && !stop_requested()) path.step(wall_now() + kPathStopLatency);
    if (!traffic.finished())
        throw Error(ExitCode::kRunFailed, "interrupted: half a self-test gives no verdict");
    result.state = path.state(wall_now());
    result.timer.merge(measure_timer(kTrafficPeriod, bare));
    const StreamKey key = flow_key(settings.seed, 0, 0);
    const auto up = records.of(RelayDirection::kUp), down = records.of(RelayDirection::kDown);
    const SessionTime start = path.start(), opened = path.opened(up.empty() ? start : receptions(up).front());
    result.direction = {
        examine({settings.links.up, settings.timelines.up, key, kRelayUp, start, opened},
                kUpBytes + path.header_bytes(), traffic.way(RelayDirection::kUp), up, path.drops_corrupted()),
        examine({settings.links.down, settings.timelines.down, key, kRelayDown, start, opened},
                kDownBytes + path.header_bytes(), traffic.way(RelayDirection::kDown), down,
                path.drops_corrupted())};
    judge(result);
    return result;
}

}  // namespace thimble
