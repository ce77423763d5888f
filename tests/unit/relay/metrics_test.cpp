// Metrics for Prometheus: their text, who asks for them and how badly, and the dashboard that shows them.
#include <arpa/inet.h>
#include <atomic>
#include <ctime>
#include <fstream>
#include <regex>
#include <set>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/process/child.hpp"
#include "common/runtime/wall_clock.hpp"
#include "netem/relay/metrics_server.hpp"
#include "netem/relay/relay_engine.hpp"
#include "netem/relay/relay_report.hpp"
#include "tests/read_text.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::StartsWith;

RelayState busy_state() {
    RelayState state;
    state.links.up.delay = milliseconds{20};
    DirectionTotals& up = state.totals.direction[0];
    up.packets.pushed = 12;
    up.packets.delivered = 10;
    up.packets.lost = 2;
    up.in_flight = 3;
    for (const int late_us : {3, 30, 3000}) {
        up.error.add(std::chrono::microseconds{late_us});
        up.error_moments.add(std::chrono::microseconds{late_us});
    }
    state.totals.closed_ports = {4, 5};
    return state;
}

TEST(MetricsText, CountsByDirectionAndCause) {
    const std::string text = metrics_text(busy_state());
    for (const char* line : {"\nthimble_netem_received_packets_total{direction=\"up\"} 12\n",
                             "\nthimble_netem_sent_packets_total{direction=\"down\"} 0\n",
                             "\nthimble_netem_dropped_packets_total{direction=\"up\",cause=\"lost\"} 2\n",
                             "\nthimble_netem_in_flight_packets{direction=\"up\"} 3\n",
                             "\nthimble_netem_asked_delay_seconds{direction=\"up\"} 0.02\n",
                             "\n# TYPE thimble_netem_lateness_seconds histogram\n",
                             "\nthimble_netem_lateness_seconds_bucket{direction=\"up\",le=\"5e-06\"} 1\n",
                             "\nthimble_netem_lateness_seconds_bucket{direction=\"up\",le=\"0.001\"} 2\n",
                             "\nthimble_netem_lateness_seconds_bucket{direction=\"up\",le=\"+Inf\"} 3\n",
                             "\nthimble_netem_lateness_seconds_count{direction=\"up\"} 3\n",
                             "\nthimble_netem_closed_port_answers_total 9\n"}) {
        EXPECT_THAT(text, HasSubstr(line));
    }
    EXPECT_NE(text.find("le=\"0.1\"} 3"), std::string::npos);
}

// Prometheus' own checker, where it is installed (Debian: prometheus).
TEST(MetricsText, PleasesPromtool) {
    const TemporaryDirectory folder;
    std::ofstream(folder / "metrics") << metrics_text(busy_state());
    const auto run = [&](const std::string& command) {
        Child child("/bin/sh", {"-c", command}, folder / "said");
        return child.wait(std::chrono::seconds{20}).value_or(-1);
    };
    if (run("command -v promtool") != 0) GTEST_SKIP() << "no promtool here: package prometheus";
    EXPECT_EQ(run("promtool check metrics < " + (folder / "metrics").string() + " 1>&2"), 0)
        << read_text(folder / "said");
}

TEST(Dashboard, AsksForMetricsThatExist) {
    const std::string text =
                          read_text(std::string(THIMBLE_SOURCE_DIR) + "/deploy/grafana/thimble-netem.json"),
                      metrics = metrics_text(busy_state());
    ASSERT_TRUE(nlohmann::json::parse(text).contains("panels"));
    std::set<std::string> names;
    const std::regex name("thimble_netem_[a-z_]+");
    for (auto at = std::sregex_iterator(text.begin(), text.end(), name); at != std::sregex_iterator(); ++at)
        names.insert(at->str());
    EXPECT_GE(names.size(), 6U);
    for (const std::string& one : names) EXPECT_THAT(metrics, HasSubstr("\n" + one + "{")) << one;
}

class Metrics : public testing::Test {
  protected:
    int visit() const {
        const SocketAddress address = server_.address().socket_address();
        const int made = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        EXPECT_EQ(connect(made, &address.any, address.size()), 0);
        const timeval patience{10, 0};
        setsockopt(made, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
        return made;
    }
    // Says it all, and returns what comes back until the end; the relay works meanwhile.
    std::string ask(const std::string& request) {
        const int socket = visit();
        std::string answer;
        std::atomic<bool> done{false};
        std::thread asker([&] {
            ::send(socket, request.data(), request.size(), MSG_NOSIGNAL);
            std::string room(4096, '\0');
            for (ssize_t size = 1; size > 0;) {
                size = recv(socket, room.data(), room.size(), 0);
                if (size > 0) answer.append(room.data(), static_cast<std::size_t>(size));
            }
            done = true;
        });
        while (!done) {
            engine_.step(wall_now() + milliseconds{2});
            server_.serve(engine_);
        }
        asker.join();
        close(socket);
        return answer;
    }

    static RelaySettings one_inlet() {
        RelaySettings settings;
        settings.inlets = {{{htonl(INADDR_LOOPBACK), 0}, {htonl(INADDR_LOOPBACK), 9}}};
        settings.most_flows = 2;
        return settings;
    }

    RelayEngine engine_{one_inlet(), nullptr};
    MetricsServer server_{{htonl(INADDR_LOOPBACK), 0}};
};

TEST_F(Metrics, AreServedAndNothingElseIs) {
    const std::string answer = ask("GET /metrics HTTP/1.1\r\nHost: x\r\n\r\n");
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 OK\r\nContent-Type: text/plain; version=0.0.4"));
    EXPECT_THAT(answer, HasSubstr("\nthimble_netem_flows 0\n"));
    EXPECT_THAT(ask("GET /metrics?x=1 HTTP/1.0\r\n\r\n"), StartsWith("HTTP/1.1 200"));
    EXPECT_THAT(ask("GET / HTTP/1.1\r\n\r\n"), StartsWith("HTTP/1.1 404"));
    EXPECT_THAT(ask("GET /metrics/../../etc/passwd HTTP/1.1\r\n\r\n"), StartsWith("HTTP/1.1 404"));
    EXPECT_THAT(ask("POST /metrics HTTP/1.1\r\n\r\n"), StartsWith("HTTP/1.1 405"));
    EXPECT_THAT(ask("GET " + std::string(9000, 'x')), StartsWith("HTTP/1.1 431"));
    EXPECT_THAT(ask(std::string("\0\xff\r\n\r\n", 6)), StartsWith("HTTP/1.1 405"));
    EXPECT_THAT(ask("GET \r\n\r\n"), StartsWith("HTTP/1.1 404"));
}

// The silent and those who leave at once cost the next visitor nothing; of more than there is room for some are turned away.
TEST_F(Metrics, OutliveHostileVisitors) {
    std::vector<int> silent;
    for (int i = 0; i < 10; ++i) silent.push_back(visit());
    for (int i = 0; i < 50; ++i) close(visit());
    EXPECT_THAT(ask("GET /metrics HTTP/1.1\r\n\r\n"), StartsWith("HTTP/1.1 200 OK"));
    for (const int one : silent) close(one);
}

// A visitor for whom there is no descriptor waits outside, and costs no processor time.
TEST_F(Metrics, SleepWhileThereIsNoDescriptor) {
    // The server's thread runs. The sanitizer needs descriptors when it first meets a class.
    EXPECT_THAT(ask("GET /metrics HTTP/1.1\r\n\r\n"), StartsWith("HTTP/1.1 200 OK"));
    const SocketAddress address = server_.address().socket_address();
    const int visitor = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    rlimit usual{};
    ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &usual), 0);
    const rlimit none{3, usual.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &none), 0);
    EXPECT_EQ(connect(visitor, &address.any, address.size()), 0);
    const std::clock_t before = std::clock();
    wall_sleep(milliseconds{400});
    const std::clock_t used = std::clock() - before;
    ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &usual), 0);
    EXPECT_LT(used, CLOCKS_PER_SEC / 5);
    close(visitor);
}

}  // namespace
}  // namespace thimble
