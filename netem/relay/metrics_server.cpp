#include "netem/relay/metrics_server.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fmt/format.h>

#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/wall_clock.hpp"
#include "netem/relay/metrics_text.hpp"

namespace thimble {
namespace {

constexpr int kLatestLook_ms = 50;
constexpr Duration kPatience = std::chrono::seconds{5};
constexpr std::size_t kMostVisitors = 16, kLongestHttpRequestBytes = 8192;

int listen_at(const UdpAddress& local) {
    const SocketAddress address = local.socket_address();
    const int opened = socket(address.any.sa_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    const int on = 1;
    if (opened >= 0 && setsockopt(opened, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) == 0 &&
        bind(opened, &address.any, address.size()) == 0 &&
        listen(opened, static_cast<int>(kMostVisitors)) == 0) {
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
    : socket_(listen_at(local)), thread_([this] { run(); }) {}

MetricsServer::~MetricsServer() {
    stop_ = true;
    thread_.join();
    for (const Visitor& visitor : visitors_) close(visitor.socket);
    close(socket_);
}

UdpAddress MetricsServer::address() const {
    SocketAddress address{};
    socklen_t size = sizeof address;
    getsockname(socket_, &address.any, &size);
    return UdpAddress::of(address);
}

void MetricsServer::run() {
    block_signals();
    std::vector<pollfd> wanted;
    while (!stop_) {
        wanted.assign(1, {socket_, POLLIN, 0});
        for (const Visitor& visitor : visitors_)
            wanted.push_back(
                {visitor.socket, static_cast<short>(visitor.answer.empty() ? POLLIN : POLLOUT), 0});
        if (poll(wanted.data(), wanted.size(), kLatestLook_ms) > 0 && (wanted[0].revents & POLLIN) != 0)
            let_in();
        std::erase_if(visitors_, [&](Visitor& visitor) {
            if (attend(visitor) && wall_now() < visitor.until) return false;
            close(visitor.socket);
            return true;
        });
    }
}

void MetricsServer::let_in() {
    const int visitor = accept4(socket_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (visitor < 0) return;
    if (visitors_.size() < kMostVisitors) {
        visitors_.push_back({visitor, wall_now() + kPatience});
    } else {
        close(visitor);
    }
}

bool MetricsServer::attend(Visitor& visitor) {
    if (visitor.answer.empty()) {
        std::array<char, 2048> room{};
        const auto size = recv(visitor.socket, room.data(), room.size(), 0);
        if (size == 0) return false;
        if (size < 0) return errno == EAGAIN || errno == EINTR;
        visitor.said.append(room.data(), static_cast<std::size_t>(size));
        if (visitor.said.size() > kLongestHttpRequestBytes) {
            visitor.answer = refusal("431 Request Header Fields Too Large");
        } else if (visitor.said.find("\r\n\r\n") != std::string::npos) {
            visitor.answer = answer_to(visitor.said);
        } else {
            return true;
        }
    }
    const auto sent = send(visitor.socket, visitor.answer.data(), visitor.answer.size(), MSG_NOSIGNAL);
    if (sent < 0) return errno == EAGAIN || errno == EINTR;
    visitor.answer.erase(0, static_cast<std::size_t>(sent));
    return !visitor.answer.empty();
}

// Of the request only its first line matters.
std::string MetricsServer::answer_to(const std::string& request) {
    if (!request.starts_with("GET ")) return refusal("405 Method Not Allowed");
    const std::string path = request.substr(4, request.find_first_of(" \r\n", 4) - 4);
    if (path.substr(0, path.find('?')) != "/metrics") return refusal("404 Not Found");
    try {
        const RelayState state = mailbox_.ask([](SteeredRelay& relay) { return relay.state(wall_now()); });
        return response("200 OK", "text/plain; version=0.0.4; charset=utf-8", metrics_text(state));
    } catch (const std::exception&) {
        return refusal("503 Service Unavailable");
    }
}

}  // namespace thimble
