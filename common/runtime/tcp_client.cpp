#include "common/runtime/tcp_client.hpp"

#include <cerrno>
#include <cstring>
#include <netinet/tcp.h>
#include <poll.h>
#include <unistd.h>

namespace thimble {
namespace {

// A peer that stops reading shows soon, and few old words wait for it.
constexpr int kUnsentBytes = 4096;

bool passes(int error) { return error == EAGAIN || error == EINTR || error == EINPROGRESS; }

// Which of them it is depends on the bytes that the other side had not read when it closed.
bool other_side_closed(int error) { return error == 0 || error == ECONNRESET || error == EPIPE; }

}  // namespace

TcpClient::TcpClient(const Endpoint& there, std::string_view advice)
    : address_(UdpAddress::resolved(there.host, there.port, advice).socket_address()) {}

TcpClient::~TcpClient() { close(); }

void TcpClient::connect() {
    close();
    socket_ = socket(address_.any.sa_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (socket_ < 0) return fail(errno);
    const int on = 1;
    setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    setsockopt(socket_, SOL_SOCKET, SO_SNDBUF, &kUnsentBytes, sizeof kUnsentBytes);
    if (::connect(socket_, &address_.any, address_.size()) != 0 && !passes(errno)) fail(errno);
}

ByteStream::State TcpClient::state() {
    if (socket_ < 0) return State::kClosed;
    if (open_) return State::kOpen;
    pollfd ready{socket_, POLLOUT, 0};
    if (poll(&ready, 1, 0) <= 0) return State::kConnecting;
    int error = 0;
    socklen_t size = sizeof error;
    getsockopt(socket_, SOL_SOCKET, SO_ERROR, &error, &size);
    if (error != 0) {
        fail(error);
        return State::kClosed;
    }
    open_ = true;
    return State::kOpen;
}

std::size_t TcpClient::send(std::string_view bytes) {
    if (!open_) return 0;
    const auto sent = ::send(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent >= 0) return static_cast<std::size_t>(sent);
    if (!passes(errno)) fail(errno);
    return 0;
}

std::size_t TcpClient::receive(std::span<char> room) {
    if (!open_ || room.empty()) return 0;
    const auto size = recv(socket_, room.data(), room.size(), MSG_DONTWAIT);
    if (size > 0) return static_cast<std::size_t>(size);
    if (size == 0) {
        fail(0);
    } else if (!passes(errno)) {
        fail(errno);
    }
    return 0;
}

void TcpClient::close() {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
    open_ = false;
}

void TcpClient::fail(int error) {
    close();
    why_ = other_side_closed(error) ? "the other side closed it" : std::strerror(error);
}

}  // namespace thimble
