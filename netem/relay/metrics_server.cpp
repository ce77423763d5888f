#include "netem/relay/metrics_server.hpp"

#include <cerrno>
#include <cstring>
#include <sys/socket.h>
#include <unistd.h>

#include <fmt/format.h>

#include "common/runtime/wall_clock.hpp"
#include "netem/relay/relay_report.hpp"

namespace thimble {
namespace {

constexpr Duration kPatience = std::chrono::seconds{5};
constexpr std::size_t kLongestHttpRequestBytes = 8192;

int listen_at(const UdpAddress& local) {
    const SocketAddress address = local.socket_address();
    const int opened = socket(address.any.sa_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    const int on = 1;
    if (opened >= 0 && setsockopt(opened, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) == 0 &&
        bind(opened, &address.any, address.size()) == 0 && listen(opened, kMostVisitors) == 0) {
        return opened;
    }
    const std::string why = std::strerror(errno);
    if (opened >= 0) close(opened);
    throw Error(ExitCode::kNetwork, "--metrics: cannot listen on TCP {}: {}; choose another port",
                to_string(local), why);
}

std::string response(std::string_view status, std::string_view type, std::string_view body) {
    return fmt::format("HTTP/1.1 {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{}",
                       status, type, body.size(), body);
}
std::string refusal(std::string_view status) {
    return response(status, "text/plain", fmt::format("{}\n", status));
}

}  // namespace

MetricsServer::MetricsServer(const UdpAddress& local)
    : server_(listen_at(local), kPatience, kLongestHttpRequestBytes,
              [this](std::string_view said) { return answer_to(said); }) {}

UdpAddress MetricsServer::address() const {
    SocketAddress address{};
    socklen_t size = sizeof address;
    getsockname(server_.listening(), &address.any, &size);
    return UdpAddress::of(address);
}

std::optional<std::string> MetricsServer::answer_to(std::string_view request) {
    if (request.size() > kLongestHttpRequestBytes) return refusal("431 Request Header Fields Too Large");
    if (request.find("\r\n\r\n") == std::string_view::npos) return std::nullopt;
    // Only the first line of the request matters.
    if (!request.starts_with("GET ")) return refusal("405 Method Not Allowed");
    const std::string_view path = request.substr(4, request.find_first_of(" \r\n", 4) - 4);
    if (path.substr(0, path.find('?')) != "/metrics") return refusal("404 Not Found");
    try {
        const RelayState state = mailbox_.ask([](SteeredRelay& relay) { return relay.state(wall_now()); });
        return response("200 OK", "text/plain; version=0.0.4; charset=utf-8", metrics_text(state));
    } catch (const std::exception&) {
        return refusal("503 Service Unavailable");
    }
}

}  // namespace thimble
