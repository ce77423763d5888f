// kernel_path_peer: measures one way through a network between two network namespaces, and compares two such measurements.
// Used by tests/kernel/jobs/netem in the guest of deploy/kernel-lane.
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sched.h>
#include <string>
#include <unistd.h>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/command_line.hpp"
#include "common/runtime/event_waiter.hpp"
#include "common/runtime/node_program.hpp"
#include "common/runtime/udp_socket.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/version.hpp"
#include "netem/relay/datagram_batch.hpp"
#include "tests/kernel/path_comparison.hpp"

namespace {

using namespace thimble;

struct PathTraffic {
    std::string sender_namespace, receiver_namespace;  // names below /run/netns, as `ip netns add` makes them
    UdpAddress to;                                     // as the sender sees the network's entrance
    UdpAddress listen;                                 // the receiver's own
    std::size_t packets = 0;
    Duration period = std::chrono::milliseconds{1};
    Duration drain = std::chrono::milliseconds{500};  // how long to wait after the last was sent
};

constexpr std::size_t kBytes = 104;         // as long as a NeedleCommand
constexpr std::uint64_t kWarmUp = 1 << 30;  // numbers of what does not count begin here
constexpr std::size_t kWarmUps = 3;

// A socket stays in the namespace in which it was made, so that one thread can have some in several.
void enter_namespace(const std::string& name) {
    const std::string path = "/run/netns/" + name;
    const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    const bool entered = descriptor >= 0 && setns(descriptor, CLONE_NEWNET) == 0;
    const int reason = errno;
    if (descriptor >= 0) close(descriptor);
    if (entered) return;
    throw Error(ExitCode::kNetwork,
                fmt::format("cannot enter the network namespace {}: {}; it is made by `ip "
                            "netns add {}`, and entering it needs root",
                            path, std::strerror(reason), name));
}

// Sends numbered datagrams into one network namespace and takes them out of another, with the receiving kernel's stamps: one
// program and one clock at both ends. Before the first that counts, some are sent that do not, a `drain` ahead: neighbours are
// known then (ARP). Needs root. Throws Error (network) if a namespace cannot be entered or a socket not made.
class PathRun {
  public:
    explicit PathRun(const PathTraffic& traffic) : traffic_(traffic), sent_(traffic.packets) {
        sample_.packets.resize(traffic.packets);
        enter_namespace(traffic.sender_namespace);
        sender_ = UdpSocket::connected(traffic.to);
        enter_namespace(traffic.receiver_namespace);
        receiver_ = UdpSocket::listening(traffic.listen);
        waiter_.add(receiver_.descriptor(), 0);
    }

    PathSample run() {
        for (std::size_t i = 0; i < kWarmUps; ++i) send(kWarmUp + i);
        receive_until(wall_now() + traffic_.drain);
        SessionTime next = wall_now();
        for (std::size_t number = 0; number < traffic_.packets; ++number) {
            sent_[number] = wall_now();
            send(number);
            next += traffic_.period;
            receive_until(next);
        }
        receive_until(wall_now() + traffic_.drain);
        sample_.untrusted = stamps_.untrusted();
        return std::move(sample_);
    }

  private:
    void send(std::uint64_t number) {
        std::array<std::uint8_t, kBytes> bytes{};
        std::memcpy(bytes.data(), &number, sizeof number);
        out_.add(bytes, nullptr);
        if (!out_.send(sender_.descriptor())[0]) {
            throw Error(ExitCode::kNetwork,
                        fmt::format("the kernel did not take packet {} for {}; is there a route?", number,
                                    to_string(traffic_.to)));
        }
    }

    void receive_until(SessionTime end) {
        while (wall_now() < end) {
            if (!waiter_.wait(end, end, events_).empty()) receive();
        }
    }

    void receive() {
        stamps_.update(read_clock_pair());
        const std::size_t count = arrivals_.receive(receiver_.descriptor());
        const SessionTime now = wall_now();
        for (std::size_t i = 0; i < count; ++i) take(arrivals_[i], now);
    }

    void take(const ReceiveBatch::Datagram& datagram, SessionTime now) {
        std::uint64_t number = UINT64_MAX;
        if (datagram.bytes.size() == kBytes) std::memcpy(&number, datagram.bytes.data(), sizeof number);
        if (number >= kWarmUp && number < kWarmUp + kWarmUps) return;
        if (number >= sent_.size()) {
            ++sample_.strangers;
        } else if (sample_.packets[number].arrived) {
            ++sample_.copies;
        } else {
            const Duration delay = stamps_.to_session(datagram.stamp_realtime_ns, now) - sent_[number];
            sample_.packets[number] = {true, number < latest_, delay};
            latest_ = std::max(latest_, number);
        }
    }

    const PathTraffic& traffic_;
    std::vector<SessionTime> sent_;
    PathSample sample_;
    UdpSocket sender_, receiver_;
    EventWaiter waiter_{false};
    std::array<epoll_event, 2> events_{};
    ReceiveBatch arrivals_;
    SendBatch out_;
    StampClock stamps_;
    std::uint64_t latest_ = 0;  // highest number that has arrived
};

struct Options {
    PathTraffic traffic;
    std::string to, listen, out, name, kernel, relay;
    PathRequest asked;
};

CLI::App* add_measure(CLI::App& app, Options& o) {
    CLI::App* measure =
        app.add_subcommand("measure", "send 1 kHz through the network, write each packet's delay");
    measure->add_option("--sender", o.traffic.sender_namespace, "network namespace")->required();
    measure->add_option("--receiver", o.traffic.receiver_namespace, "network namespace")->required();
    measure->add_option("--to", o.to, "where the sender sends to")->type_name("HOST:PORT")->required();
    measure->add_option("--listen", o.listen, "where the receiver listens")
        ->type_name("[HOST:]PORT")
        ->required();
    measure->add_option("--packets", o.traffic.packets, "how many")
        ->check(CLI::Range(100, 1000000))
        ->required();
    measure->add_option("--out", o.out, "file for the delays")->required();
    return measure;
}

CLI::App* add_compare(CLI::App& app, Options& o) {
    CLI::App* compare =
        app.add_subcommand("compare", "the kernel's netem beside thimble-netem; 1 if they disagree");
    compare->add_option("--name", o.name, "of the profile, for the table")->required();
    compare->add_option("--kernel", o.kernel, "file that measure wrote")->required();
    compare->add_option("--relay", o.relay, "file that measure wrote")->required();
    compare->add_option("--delay-s", o.asked.delay_s, "what was asked")->check(CLI::Range(0.0, 60.0));
    compare->add_option("--normal-s", o.asked.normal_s, "standard deviation of a normal jitter")
        ->check(CLI::Range(0.0, 60.0));
    compare->add_option("--loss", o.asked.loss, "share of the packets")->check(CLI::Range(0.0, 1.0));
    return compare;
}

int measure(Options& o) {
    o.traffic.to = read_udp_address(o.to, "--to");
    o.traffic.listen = read_udp_address(o.listen, "--listen");
    write_path_sample(PathRun(o.traffic).run(), o.out);
    return static_cast<int>(ExitCode::kOk);
}

int compare(const Options& o) {
    const PathSummary kernel = summarise(read_path_sample(o.kernel));
    const PathSummary relay = summarise(read_path_sample(o.relay));
    const std::vector<std::string> findings = disagreements(o.asked, kernel, relay);
    fmt::print("{}", path_table_rows(o.name, o.asked, kernel, relay));
    for (const std::string& finding : findings) fmt::print(stderr, "{}: {}\n", o.name, finding);
    return static_cast<int>(findings.empty() ? ExitCode::kOk : ExitCode::kRunFailed);
}

int run(int argc, char** argv) {
    CLI::App app("One way through a network, measured between two network namespaces.", "kernel_path_peer");
    app.set_version_flag("--version", std::string(kVersion));
    app.require_subcommand(1);
    Options options;
    CLI::App* asked_measure = add_measure(app, options);
    CLI::App* asked_compare = add_compare(app, options);
    app.add_subcommand("head", "the head of the table that compare fills");
    if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
    if (asked_measure->parsed()) return measure(options);
    if (asked_compare->parsed()) return compare(options);
    fmt::print("{}", path_table_head());
    return static_cast<int>(ExitCode::kOk);
}

}  // namespace

int main(int argc, char** argv) {
    return guarded_main("kernel_path_peer", [&] { return run(argc, argv); });
}
