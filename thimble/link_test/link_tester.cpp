#include <algorithm>
#include <array>
#include <cerrno>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/event_waiter.hpp"
#include "common/runtime/wall_clock.hpp"
#include "thimble/link_test/port_probe.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

constexpr int kKnocks = 10;
constexpr Duration kBetweenKnocks = milliseconds{100};
constexpr int kTries = 3;                                    // of a size
constexpr Duration kMostPatience = std::chrono::seconds{2};  // with a side that answers nothing
constexpr std::size_t kMostExchanges = 100'000;

enum class Passage : std::uint8_t { kPasses, kLost, kRefusedHere, kNoAnswer };

class LinkTester {
  public:
    explicit LinkTester(const LinkTestPlan& plan);

    LinkFigures run();

  private:
    bool going_on() const { return plan_.stop == nullptr || !*plan_.stop; }
    void pump(SessionTime until);
    void listen(SessionTime latest);
    void probe_all_ports();
    void find_mtu();
    Passage passage(PortProbe& probe, std::size_t bytes);
    void load();
    void count();
    Duration patience() const;
    LinkFigures figures();

    const LinkTestPlan& plan_;
    EventWaiter waiter_{false};
    std::vector<PortProbe> probes_;
    MtuFigures mtu_;
    std::vector<ClockExchange> exchanges_;
    std::uint32_t stalls_ = 0;
};

LinkTester::LinkTester(const LinkTestPlan& plan) : plan_(plan) {
    const auto traffic = session_traffic();
    const std::uint64_t asker = system_entropy();
    probes_.reserve(plan.ports.size());
    for (const Port port : plan.ports) {
        const unsigned number = plan.base_port + static_cast<unsigned>(port);
        const UdpAddress remote = read_udp_address(fmt::format("{}:{}", plan.host, number), "HOST");
        probes_.emplace_back(traffic[static_cast<std::size_t>(port)], remote, asker);
        waiter_.add(probes_.back().descriptor(), probes_.size() - 1);
    }
    exchanges_.reserve(kMostExchanges);
}

LinkFigures LinkTester::run() {
    probe_all_ports();
    const bool anybody =
        std::any_of(probes_.begin(), probes_.end(), [](const PortProbe& p) { return p.answers(); });
    if (anybody) {
        find_mtu();
        load();
        count();
    }
    return figures();
}

void LinkTester::listen(SessionTime latest) {
    std::array<epoll_event, 32> room{};
    for (const epoll_event& event : waiter_.wait(latest, latest, room))
        probes_[event.data.u64].take_all(exchanges_);
}

void LinkTester::pump(SessionTime until) {
    while (wall_now() < until && going_on()) listen(until);
}

void LinkTester::probe_all_ports() {
    const auto concluded = [&] {
        return std::all_of(probes_.begin(), probes_.end(), [](const PortProbe& p) { return p.concluded(); });
    };
    for (int i = 0; i < kKnocks && going_on() && !concluded(); ++i) {
        const SessionTime next = wall_now() + kBetweenKnocks;
        for (PortProbe& probe : probes_) {
            if (!probe.concluded()) probe.say_hello(wall_now());
        }
        while (wall_now() < next && going_on() && !concluded()) listen(next);
    }
}

// For an answer: four round trips, and a fair while.
Duration LinkTester::patience() const {
    Duration longest{};
    for (const PortProbe& probe : probes_) longest = std::max(longest, probe.median_round_trip());
    return std::min<Duration>(4 * longest + milliseconds{30}, kMostPatience);
}

// By halving: what passes at one size passes at every smaller one.
void LinkTester::find_mtu() {
    const auto probe =
        std::find_if(probes_.begin(), probes_.end(), [](const PortProbe& p) { return p.answers(); });
    if (probe == probes_.end()) return;
    std::size_t good = 0, bad = kLargestProbeBytes + 1;
    bool refused_at_bad = false;
    for (std::size_t bytes = kMaxDatagramBytes; bad - good > 1 && going_on();
         bytes = good + (bad - good) / 2) {
        const Passage found = passage(*probe, bytes);
        if (found == Passage::kNoAnswer) break;  // the report shows the loss
        if (found == Passage::kPasses) {
            good = bytes;
        } else {
            bad = bytes;
            refused_at_bad = found == Passage::kRefusedHere;
            if (good == 0) break;  // not even a session's own
        }
    }
    mtu_ = {good, refused_at_bad};
}

// By order, because a busy machine answers late: a datagram is lost where only the one behind it is answered.
Passage LinkTester::passage(PortProbe& probe, std::size_t bytes) {
    const SessionTime given_up = wall_now() + kMostPatience + patience();
    for (int lost = 0; lost < kTries;) {
        if (!going_on() || wall_now() > given_up) return Passage::kNoAnswer;
        if (probe.query(wall_now(), bytes) == EMSGSIZE) return Passage::kRefusedHere;
        probe.follow(wall_now());
        const SessionTime until = wall_now() + patience();
        do {
            listen(until);
        } while (!probe.query_answered() && wall_now() < until);
        if (probe.query_answered()) return Passage::kPasses;
        if (probe.follower_answered()) ++lost;
    }
    return Passage::kLost;
}

void LinkTester::load() {
    const SessionTime begin = wall_now(), end = begin + plan_.duration;
    for (PortProbe& probe : probes_) {
        if (probe.answers()) probe.start(begin);
    }
    while (going_on()) {
        const SessionTime now = wall_now();
        if (now >= end) break;
        SessionTime next = end;
        for (PortProbe& probe : probes_) {
            if (probe.next_due() <= now) stalls_ += probe.send_due(now);
            next = std::min(next, probe.next_due());
        }
        listen(next);
    }
    for (PortProbe& probe : probes_) {
        if (probe.answers()) probe.finish(wall_now());
    }
    pump(wall_now() + patience());  // what is still on its way
}

void LinkTester::count() {
    const auto done = [&] {
        return std::all_of(probes_.begin(), probes_.end(),
                           [](const PortProbe& p) { return !p.answers() || p.counted(); });
    };
    for (int i = 0; i < kKnocks && going_on() && !done(); ++i) {
        for (PortProbe& probe : probes_) {
            if (probe.answers() && !probe.counted()) probe.query(wall_now(), probe.traffic().bytes);
        }
        const SessionTime next = wall_now() + patience();
        while (wall_now() < next && going_on() && !done()) listen(next);
    }
}

LinkFigures LinkTester::figures() {
    LinkFigures link;
    link.host = plan_.host;
    link.base_port = plan_.base_port;
    for (const PortProbe& probe : probes_) link.ports.push_back(probe.figures());
    link.mtu = mtu_;
    link.clock = summarize_clock(exchanges_);
    link.stalls = stalls_;
    return link;
}

}  // namespace

LinkFigures test_link(const LinkTestPlan& plan) { return LinkTester(plan).run(); }

}  // namespace thimble
