// thimble-bench ends: sender and receiver of any path, each in a process of its own.
//
//   thimble-netem pair --precise --link up.delay_s=0.05 -- thimble-bench ends send -- thimble-bench ends hear --delay-ms 50
//
// The error of a datagram is the time from sending plus the delay to the kernel's stamp at the receiver. Both ends are on one machine.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <poll.h>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "bench/network/relay_rounds.hpp"
#include "bench/studies.hpp"
#include "common/error.hpp"
#include "common/runtime/command_line.hpp"
#include "common/runtime/stamp_clock.hpp"
#include "common/runtime/wall_clock.hpp"
#include "netem/relay/datagram_batch.hpp"
#include "netem/relay/relay_service.hpp"

namespace thimble {
namespace {

constexpr std::uint16_t kEndsPort = 5299;
constexpr Duration kPeriod = std::chrono::microseconds{1000};
constexpr Duration kEndsWindow = std::chrono::milliseconds{250};
constexpr Duration kPatienceOfEnds = std::chrono::seconds{1};
constexpr std::size_t kEndsBytes = 104;

struct EndsOptions {
    std::string role, to;
    double delay_ms = 50, seconds = 5;
};

// The time of sending stands in each datagram.
int send_datagrams(const EndsOptions& options) {
    const char* const peer = std::getenv("THIMBLE_HOST");
    const std::string host = !options.to.empty() ? options.to : (peer != nullptr ? peer : "127.0.0.1");
    const UdpSocket socket =
        UdpSocket::connected(read_udp_address(fmt::format("{}:{}", host, kEndsPort), "--to"));
    std::array<std::uint8_t, kEndsBytes> datagram{};
    wall_sleep(std::chrono::milliseconds{300});  // the other end begins to hear
    const SessionTime end = wall_now() + from_seconds(options.seconds);
    for (SessionTime next = wall_now(); next < end; next += kPeriod) {
        if (const SessionTime now = wall_now(); next > now) wall_sleep(next - now);
        const std::int64_t sent = to_nanoseconds(wall_now());
        std::memcpy(datagram.data(), &sent, sizeof sent);
        if (::send(socket.descriptor(), datagram.data(), datagram.size(), 0) < 0)
            continue;  // no receiver yet
    }
    wall_sleep(kPatienceOfEnds);
    return 0;
}

struct HeardErrors {
    ErrorWindows windows;
    std::vector<double> window{}, all_us{};
    SessionTime window_end = kNever;

    void add(SessionTime sent, double error_us) {
        if (window_end == kNever || sent >= window_end) {
            windows.add(std::exchange(window, {}));
            window_end = sent + kEndsWindow;
        }
        window.push_back(error_us);
        all_us.push_back(error_us);
    }
};

void print_errors(const char* what, HeardErrors& heard) {
    std::sort(heard.all_us.begin(), heard.all_us.end());
    const WindowErrors errors = heard.windows.errors();
    const auto at = [&](double share) {
        return heard.all_us[static_cast<std::size_t>(share * static_cast<double>(heard.all_us.size() - 1))];
    };
    fmt::print(
        "{}: {} datagrams, w50 {:.2f} us, w99 {:.2f} us; of all: least {:.2f}, 50 % {:.2f}, 99 % {:.2f}, "
        "worst {:.0f} us\n",
        what, heard.all_us.size(), errors.w50_us, errors.w99_us, at(0), at(0.5), at(0.99), at(1));
}

int hear_datagrams(const EndsOptions& options) {
    const UdpSocket socket =
        UdpSocket::listening(read_udp_address(fmt::format("0.0.0.0:{}", kEndsPort), "port"));
    ReceiveBatch arrivals;
    ArrivalClock clock;
    HeardErrors heard;
    const SessionTime end = wall_now() + from_seconds(options.seconds) + kPatienceOfEnds;
    while (wall_now() < end) {
        pollfd wanted{socket.descriptor(), POLLIN, 0};
        if (poll(&wanted, 1, 50) <= 0) continue;
        const std::size_t count = arrivals.receive(socket.descriptor());
        for (std::size_t i = 0; i < count; ++i) {
            std::int64_t sent = 0;
            if (arrivals[i].bytes.size() < sizeof sent) continue;
            std::memcpy(&sent, arrivals[i].bytes.data(), sizeof sent);
            const SessionTime arrival = clock.arrival(arrivals[i].stamp_realtime_ns);
            heard.add(from_nanoseconds(sent),
                      1e-3 * static_cast<double>(to_nanoseconds(arrival) - sent) - 1e3 * options.delay_ms);
        }
    }
    if (heard.all_us.empty()) throw Error(ExitCode::kNetwork, "no datagram has come to port {}", kEndsPort);
    print_errors("through the path", heard);
    return 0;
}

int spin(const EndsOptions& options) {
    const bool granted = ask_for_precision({}, true);
    HeardErrors heard;
    const auto rounds = static_cast<int>(from_seconds(options.seconds) / kEndsWindow);
    for (int i = 0; i < rounds; ++i) {
        const LatenessRound round = spinner_lateness(kEndsWindow);
        for (const double error : round.errors_us) heard.add(SessionTime{(i + 1) * kEndsWindow}, error);
    }
    print_errors(granted ? "bare spinner" : "bare spinner, default scheduling", heard);
    return 0;
}

}  // namespace

int network_ends(int argc, char** argv) {
    CLI::App app("The two ends of any path: the error of each datagram's delay.", "thimble-bench ends");
    EndsOptions options;
    app.add_option("role", options.role, "send, hear, or spin: a bare spinner instead")
        ->required()
        ->check(CLI::IsMember({"send", "hear", "spin"}));
    app.add_option("--to", options.to, "the receiver's address, else THIMBLE_HOST");
    app.add_option("--delay-ms", options.delay_ms, "of the path")->capture_default_str();
    app.add_option("--seconds", options.seconds, "how long")
        ->check(CLI::Range(0.5, 3600.0))
        ->capture_default_str();
    if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
    if (options.role == "spin") return spin(options);
    return options.role == "send" ? send_datagrams(options) : hear_datagrams(options);
}

}  // namespace thimble
