#include "common/runtime/tcp_server.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "common/error.hpp"
#include "common/runtime/udp_socket.hpp"

namespace thimble {
namespace {

[[noreturn]] void fail_to_listen(const Endpoint& local, const char* why) {
    throw Error(ExitCode::kNetwork, "cannot listen on TCP {}:{}: {}; name another address with --listen",
                local.host, local.port, why);
}

sockaddr_in address_of(const Endpoint& local) {
    addrinfo hints{};
    hints.ai_family = AF_INET;
    hints.ai_socktype = SOCK_STREAM;
    addrinfo* found = nullptr;
    const int error = getaddrinfo(local.host.c_str(), nullptr, &hints, &found);
    if (error != 0 || found == nullptr) fail_to_listen(local, gai_strerror(error));
    sockaddr_in address{};
    std::memcpy(&address, found->ai_addr, sizeof address);
    freeaddrinfo(found);
    address.sin_port = htons(local.port);
    return address;
}

}  // namespace

TcpServer::TcpServer(const Endpoint& local)
    : socket_(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
    if (socket_.get() < 0) fail_to_listen(local, std::strerror(errno));
    clients_.reserve(kMostClients);
    const sockaddr_in address = address_of(local);
    const int on = 1;
    setsockopt(socket_.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    if (bind(socket_.get(), raw(address), sizeof address) != 0 || listen(socket_.get(), 4) != 0)
        fail_to_listen(local, std::strerror(errno));
}

TcpServer::~TcpServer() {
    for (const Client& client : clients_) close(client.socket);
}

std::uint16_t TcpServer::port() const {
    sockaddr_in address{};
    socklen_t size = sizeof address;
    getsockname(socket_.get(), static_cast<sockaddr*>(static_cast<void*>(&address)), &size);
    return ntohs(address.sin_port);
}

void TcpServer::look_after_clients() {
    for (;;) {
        const int client = accept4(socket_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
        if (client < 0) break;
        if (clients_.size() < kMostClients) {
            clients_.push_back({client});
        } else {
            close(client);
        }
    }
    for (Client& client : clients_) {
        throw_away_input(client);
        send_rest(client);
        if (client.gone) close(client.socket);
    }
    std::erase_if(clients_, [](const Client& client) { return client.gone; });
}

// Reads a little at a time, so that a client that floods costs little.
void TcpServer::throw_away_input(Client& client) {
    std::array<std::uint8_t, 4096> bytes{};
    for (int i = 0; i < 16; ++i) {
        const auto size = recv(client.socket, bytes.data(), bytes.size(), MSG_DONTWAIT);
        if (size > 0) continue;
        client.gone = size == 0 || (errno != EAGAIN && errno != EINTR);
        return;
    }
}

void TcpServer::send_rest(Client& client) {
    while (!client.left.empty() && !client.gone) {
        const auto sent =
            ::send(client.socket, client.left.data(), client.left.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
        if (sent < 0) {
            client.gone = errno != EAGAIN && errno != EINTR;
            return;
        }
        client.left.erase(client.left.begin(), client.left.begin() + sent);
    }
}

void TcpServer::send(Bytes message) {
    for (Client& client : clients_) {
        send_rest(client);
        if (!client.left.empty()) {
            ++skipped_;
            continue;
        }
        client.left.assign(message.begin(), message.end());
        send_rest(client);
    }
}

bool TcpServer::all_sent() {
    bool all = true;
    for (Client& client : clients_) {
        send_rest(client);
        all = all && (client.left.empty() || client.gone);
    }
    return all;
}

}  // namespace thimble
