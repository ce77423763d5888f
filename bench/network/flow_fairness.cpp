#include "bench/network/flow_fairness.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "bench/network/helper_thread.hpp"
#include "bench/network/window_errors.hpp"
#include "common/runtime/event_waiter.hpp"
#include "common/runtime/wall_clock.hpp"
#include "netem/relay/relay_engine.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kSessionBytes = 144;
constexpr Duration kDelay = milliseconds{50};
constexpr Duration kRound = milliseconds{50};  // each flow sends once in it, all spread evenly
constexpr Duration kTick = milliseconds{1};

RelaySettings settings_for(std::size_t flows, const UdpAddress& to) {
    RelaySettings settings;
    settings.inlets = {{loopback(), to}};
    settings.links.up.delay = settings.links.down.delay = kDelay;
    settings.links.up.capacity = 100'000;
    settings.most_flows = flows;
    return settings;
}

class Sent final : public PacketSink {
  public:
    explicit Sent(std::size_t flows) : of_flow(flows) {}
    void add(const PacketRecord& record) override {
        if (record.fate != LoggedFate::kSent || record.flow >= of_flow.size()) return;
        ++of_flow[record.flow];
        if (record.flow + 1 < of_flow.size() || !greedy)
            late_us.push_back(us(Duration{record.sent_ns - record.due_ns}));
    }
    std::vector<double> of_flow, late_us;
    bool greedy = false;  // the last flow is
};

// The clients' end.
class Clients {
  public:
    Clients(std::size_t flows, double greedy_per_s, const UdpAddress& relay)
        : ordinary_(flows), greedy_per_tick_(greedy_per_s * to_seconds(kTick)) {
        for (std::size_t i = 0; i < flows + (greedy_per_s > 0 ? 1 : 0); ++i) {
            sockets_.push_back(UdpSocket::connected(relay));
        }
        of_flow.resize(sockets_.size());
    }

    // Every flow once, a few per tick: a burst of a thousand would be the kernel's matter, not the relay's.
    void run(Duration length, const std::atomic<bool>& stop) {
        be_ordinary();
        const double ticks_per_round = static_cast<double>(kRound / kTick);
        const double per_tick = static_cast<double>(ordinary_) / ticks_per_round;
        introduce();
        EventWaiter waiter(false);
        std::array<epoll_event, 1> room{};
        double owed = 0, greedy_owed = 0;
        std::size_t turn = 0;
        const SessionTime end = wall_now() + length;
        for (SessionTime next = wall_now() + kTick; !stop && next < end; next += kTick) {
            while (wall_now() < next) waiter.wait(next, next, room);
            for (owed += per_tick; owed >= 1; --owed) send(turn++ % ordinary_);
            for (greedy_owed += greedy_per_tick_; greedy_owed >= 1; --greedy_owed) send(ordinary_);
        }
    }

    std::vector<double> of_flow;

  private:
    // The relay numbers flows as they come: the greedy one last.
    void introduce() {
        for (std::size_t flow = 0; flow < sockets_.size(); ++flow) {
            send(flow);
            if (flow % 16 == 15) wall_sleep(kTick);
        }
    }
    void send(std::size_t flow) {
        const std::array<std::uint8_t, kSessionBytes> bytes{};
        batch_.add(bytes, nullptr);
        for (const bool accepted : batch_.send(sockets_[flow].descriptor()))
            of_flow[flow] += accepted ? 1 : 0;
    }

    std::size_t ordinary_;
    double greedy_per_tick_;
    std::vector<UdpSocket> sockets_;
    SendBatch batch_;
};

double sum_of(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum;
}

double quantile(std::vector<double>& values, double share) {
    if (values.empty()) return 0;
    const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + place, values.end());
    return values[static_cast<std::size_t>(place)];
}

FairnessRound judge(Sent& out, const std::vector<double>& in, std::size_t ordinary, double wall_s) {
    FairnessRound round;
    round.offered_per_s = sum_of(in) / wall_s;
    round.delivered = sum_of(out.of_flow) / sum_of(in);
    double sum = 0, squares = 0;
    round.least = 1;
    for (std::size_t i = 0; i < ordinary; ++i) {
        const double share = in[i] > 0 ? out.of_flow[i] / in[i] : 1;
        round.least = std::min(round.least, share);
        round.most = std::max(round.most, share);
        sum += share;
        squares += share * share;
    }
    round.index = squares > 0 ? sum * sum / (static_cast<double>(ordinary) * squares) : 0;
    round.late50_us = quantile(out.late_us, 0.5);
    round.late99_us = quantile(out.late_us, 0.99);
    return round;
}

}  // namespace

FairnessRound share_relay(std::size_t flows, double greedy_per_s, Duration length) {
    const std::size_t all = flows + (greedy_per_s > 0 ? 1 : 0);
    const UdpSocket sink = UdpSocket::listening(loopback());
    Sent out(all);
    out.greedy = all > flows;
    RelayEngine engine(settings_for(all, sink.local()), &out);
    Clients clients(flows, greedy_per_s, engine.inlet_address(0));
    std::atomic<bool> all_sent = false;
    {
        const Helper draining([&](const std::atomic<bool>& stop) {
            be_ordinary();
            ReceiveBatch in;
            while (!stop) {
                if (in.receive(sink.descriptor()) == 0) wall_sleep(kTick);
            }
        });
        const Helper sending([&](const std::atomic<bool>& stop) {
            clients.run(length, stop);
            all_sent = true;
        });
        while (!all_sent) engine.step(wall_now() + kTick);
        const SessionTime end = wall_now() + 2 * kDelay;
        while (wall_now() < end) engine.step(end);
    }
    FairnessRound round = judge(out, clients.of_flow, flows, to_seconds(length));
    round.dropped_by_kernel =
        static_cast<double>(engine.totals(wall_now()).dropped_by_kernel) / sum_of(clients.of_flow);
    return round;
}

}  // namespace thimble
