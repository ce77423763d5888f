#include <array>
#include <numeric>

#include <fmt/format.h>

#include "netem/relay/relay_report.hpp"

namespace thimble {
namespace {

constexpr std::array<std::string_view, 2> kWays{"up", "down"};  // RelayDirection

// Upper bounds of the buckets of lateness, from what a spinning relay reaches to a stall.
constexpr std::array kBounds{
    std::chrono::microseconds{5},     std::chrono::microseconds{10},    std::chrono::microseconds{20},
    std::chrono::microseconds{50},    std::chrono::microseconds{100},   std::chrono::microseconds{200},
    std::chrono::microseconds{500},   std::chrono::microseconds{1000},  std::chrono::microseconds{5000},
    std::chrono::microseconds{20000}, std::chrono::microseconds{100000}};

class MetricsPrinter {
  public:
    explicit MetricsPrinter(const RelayState& state) : state_(state) {}

    std::string print() {
        print_packets();
        print_delays();
        print_asked();
        print_machine();
        return std::move(text_);
    }

  private:
    template <class Value>
    void sample(std::string_view name, std::string_view labels, Value value) {
        text_ += fmt::format("thimble_netem_{}{} {}\n", name,
                             labels.empty() ? "" : fmt::format("{{{}}}", labels), value);
    }
    void begin(std::string_view name, std::string_view type, std::string_view help) {
        text_ +=
            fmt::format("# HELP thimble_netem_{0} {2}\n# TYPE thimble_netem_{0} {1}\n", name, type, help);
    }
    template <class Value>
    void single(std::string_view name, std::string_view type, std::string_view help, Value value) {
        begin(name, type, help);
        sample(name, "", value);
    }
    template <class Of>
    void by_way(std::string_view name, std::string_view type, std::string_view help, const Of& of) {
        begin(name, type, help);
        for (std::size_t way = 0; way < kWays.size(); ++way)
            sample(name, fmt::format("direction=\"{}\"", kWays[way]), of(state_.totals.direction[way]));
    }
    template <class Of>
    void count(std::string_view name, std::string_view help, const Of& of) {
        by_way(name, "counter", help, of);
    }

    void print_packets() {
        count("received_packets_total", "Datagrams that came in.",
              [](const auto& d) { return d.packets.pushed; });
        count("sent_packets_total", "Datagrams that left, copies included.",
              [](const auto& d) { return d.packets.delivered - d.refused; });
        count("sent_bytes_total", "Bytes of their payloads.", [](const auto& d) { return d.bytes; });
        print_drops();
        count("duplicated_packets_total", "Second copies made.",
              [](const auto& d) { return d.packets.duplicated; });
        count("corrupted_packets_total", "Datagrams with flipped bits.",
              [](const auto& d) { return d.packets.corrupted; });
        count("reordered_packets_total", "Datagrams that left after a later one.",
              [](const auto& d) { return d.packets.reordered; });
        count("marked_packets_total", "Datagrams that were marked instead of lost (ECN).",
              [](const auto& d) { return d.packets.marked; });
        by_way("in_flight_packets", "gauge", "Datagrams that wait or are delayed now.",
               [](const auto& d) { return d.in_flight; });
    }

    void print_drops() {
        begin("dropped_packets_total", "counter", "Datagrams that never left, by cause.");
        for (std::size_t way = 0; way < kWays.size(); ++way) {
            const DirectionTotals& d = state_.totals.direction[way];
            const std::array<std::pair<std::string_view, std::uint64_t>, 6> causes{
                {{"lost", d.packets.lost},
                 {"outage", d.packets.outage},
                 {"queue_full", d.packets.queue_full},
                 {"overflowed", d.packets.overflowed},
                 {"empty_or_too_long", d.packets.oversized},
                 {"refused_by_kernel", d.refused}}};
            for (const auto& [cause, packets] : causes)
                sample("dropped_packets_total",
                       fmt::format("direction=\"{}\",cause=\"{}\"", kWays[way], cause), packets);
        }
    }

    void print_delays() {
        begin("lateness_seconds", "histogram", "How long after its due time a datagram left, in seconds.");
        for (std::size_t way = 0; way < kWays.size(); ++way) {
            const DirectionTotals& d = state_.totals.direction[way];
            const std::string label = fmt::format("direction=\"{}\"", kWays[way]);
            for (const auto bound : kBounds) {
                sample("lateness_seconds_bucket", fmt::format("{},le=\"{:g}\"", label, to_seconds(bound)),
                       d.error.count_up_to(bound));
            }
            sample("lateness_seconds_bucket", label + ",le=\"+Inf\"", d.error.count());
            sample("lateness_seconds_sum", label, d.error_moments.sum_s());
            sample("lateness_seconds_count", label, d.error.count());
        }
        begin("delay_seconds", "summary", "How long after it came in a datagram left.");
        for (std::size_t way = 0; way < kWays.size(); ++way) {
            const DirectionTotals& d = state_.totals.direction[way];
            const std::string label = fmt::format("direction=\"{}\"", kWays[way]);
            sample("delay_seconds_sum", label, d.delay_moments.sum_s());
            sample("delay_seconds_count", label, d.delay.count());
        }
    }

    void print_asked() {
        const std::array<const LinkSettings*, 2> links{&state_.links.up, &state_.links.down};
        begin("asked_delay_seconds", "gauge", "The mean delay that holds now.");
        for (std::size_t way = 0; way < kWays.size(); ++way)
            sample("asked_delay_seconds", fmt::format("direction=\"{}\"", kWays[way]),
                   to_seconds(mean_delay(*links[way])));
        begin("asked_loss_ratio", "gauge", "The share of datagrams that the link loses in the long run.");
        for (std::size_t way = 0; way < kWays.size(); ++way)
            sample("asked_loss_ratio", fmt::format("direction=\"{}\"", kWays[way]), mean_loss(*links[way]));
    }

    void print_machine() {
        const RelayTotals& t = state_.totals;
        single("flows", "gauge", "Clients now.", t.flows);
        single("flows_opened_total", "counter", "Clients since the start.", t.flows_opened);
        single("flows_refused_packets_total", "counter", "Datagrams of clients beyond --max-flows.",
               t.flows_refused);
        single("flows_failed_packets_total", "counter",
               "Datagrams of clients without a socket to the server.", t.flows_failed);
        single("stalls_total", "counter", "Wake-ups more than 1 ms late.", t.stalls);
        single("dropped_by_kernel_packets_total", "counter", "Datagrams that the kernel had no buffer for.",
               t.dropped_by_kernel);
        single("closed_port_answers_total", "counter", "Answers that the port behind --to is closed.",
               std::accumulate(t.closed_ports.begin(), t.closed_ports.end(), std::uint64_t{0}));
        single("log_missing_packets_total", "counter", "Datagrams that are missing in the packet log.",
               t.log_missing);
        single("uptime_seconds", "gauge", "Since the start.", to_seconds(t.running));
    }

    const RelayState& state_;
    std::string text_;
};

}  // namespace

std::string metrics_text(const RelayState& state) { return MetricsPrinter(state).print(); }

}  // namespace thimble
