#include "common/runtime/udp_channel.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <cerrno>
#include <cstring>
#include <poll.h>
#include <utility>

#include <fmt/format.h>

#include "common/runtime/realtime_loop.hpp"

namespace thimble {
namespace {

// A few hundred messages: bursts after a stall must not be lost in the kernel.
constexpr int kBufferBytes = 1 << 20;

sockaddr_in resolve(const Endpoint& endpoint) {
    return UdpAddress::resolved(endpoint.host, endpoint.port, "check [network] in the configuration")
        .generic();
}

bool is_loopback(std::uint32_t address) { return address >> 24U == 127; }

}  // namespace

bool means_this_machine(const std::string& host) {
    try {
        const std::uint32_t address = ntohl(resolve({host, 0}).sin_addr.s_addr);
        return is_loopback(address) || address == INADDR_ANY;
    } catch (const Error&) {
        return false;  // opening a channel to it reports the error
    }
}

bool leaves_this_machine(const std::string& host) {
    try {
        return !is_loopback(ntohl(resolve({host, 0}).sin_addr.s_addr));
    } catch (const Error&) {
        return true;
    }
}

UdpChannel::UdpChannel(const std::optional<Endpoint>& local, const Endpoint& remote)
    : socket_(UdpSocket::open()), out_(socket_.descriptor()), remote_(resolve(remote)) {
    for (const int option : {SO_RCVBUF, SO_SNDBUF}) {
        setsockopt(socket_.descriptor(), SOL_SOCKET, option, &kBufferBytes, sizeof kBufferBytes);
    }
    know(remote_.sin_addr.s_addr);
    if (local) bind_to(*local);
}

void UdpChannel::bind_to(const Endpoint& local) {
    const sockaddr_in address = resolve(local);
    if (bind(socket_.descriptor(), raw(address), sizeof address) == 0) return;
    const int error = errno;
    const char* advice =
        error == EADDRINUSE
            ? "is another thimble program running there? Stop it, or choose another base_port in [network]"
            : "check the host in [network]";
    throw Error(ExitCode::kNetwork, "cannot listen on UDP {}:{}: {}; {}", local.host, local.port,
                std::strerror(error), advice);
}

void UdpChannel::send(Bytes datagram) { send_to(remote_, datagram); }

void UdpChannel::answer(Bytes datagram) {
    if (source_.sin_port != 0) send_to(source_, datagram);
}

void UdpChannel::follow() {
    if (peer_moves_) remote_ = source_;
}

void UdpChannel::send_to(const sockaddr_in& address, Bytes datagram) {
    const auto sent = sendto(out_, datagram.data(), datagram.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
                             raw(address), sizeof address);
    ++(sent < 0 ? counters_.send_failed : counters_.sent);
    if (sent_ == nullptr) return;
    if (sent < 0)
        throw Error(ExitCode::kNetwork, "lock-step: cannot send '{}' to {}: {}", flow(sent_to_).what,
                    to_string(owner(sent_to_)), std::strerror(errno));
    ++*sent_;
}

void UdpChannel::count_sent(Port port, std::uint16_t& sent) {
    sent_to_ = port;
    sent_ = &sent;
}

void UdpChannel::await_announced(Port port, std::uint16_t base_port, Duration limit) {
    listens_at_ = port;
    base_port_ = base_port;
    limit_ = limit;
    known_empty_ = true;
}

// On one machine a datagram is there once its sender has sent it: the wait is short.
void UdpChannel::wait_for_announced() {
    constexpr std::int64_t kLook_ms = 100;  // a signal may have ended another thread's wait
    pollfd mail{socket_.descriptor(), POLLIN, 0};
    auto left_ms = std::chrono::ceil<std::chrono::milliseconds>(limit_).count();
    int found = 0;
    for (; found <= 0 && left_ms > 0 && !stop_requested(); left_ms -= kLook_ms)
        found = poll(&mail, 1, static_cast<int>(std::min(left_ms, kLook_ms)));
    if (found > 0) return;
    const int missing = std::exchange(announced_, 0);  // it is waited for once
    throw DatagramLost(
        listens_at_,
        fmt::format("lock-step: the machine lost a datagram of '{}' from {} to {}: {} announced datagram{} "
                    "did not come within {} s (is net.core.rmem_max too small?)",
                    flow(listens_at_).what, to_string(flow(listens_at_).hears), to_string(owner(listens_at_)),
                    missing, missing == 1 ? "" : "s", to_seconds(limit_)));
}

bool UdpChannel::hear_outside() {
    pollfd mail{socket_.descriptor(), POLLIN, 0};
    hears_outside_ = poll(&mail, 1, 0) > 0;
    if (hears_outside_) known_empty_ = false;
    return hears_outside_;
}

Bytes UdpChannel::take() {
    // An announced datagram is waited for, however many strangers are in front of it.
    for (int refused = 0; refused < kMostRefusedAtOnce || announced_ > 0; ++refused) {
        iovec part{buffer_.data(), buffer_.size()};
        alignas(cmsghdr) std::array<std::uint8_t, 64> control{};
        msghdr message{};
        message.msg_name = &source_;
        message.msg_namelen = sizeof source_;
        message.msg_iov = &part;
        message.msg_iovlen = 1;
        message.msg_control = stamping_ ? control.data() : nullptr;
        message.msg_controllen = stamping_ ? control.size() : 0;
        const auto size = recvmsg(socket_.descriptor(), &message, MSG_DONTWAIT);
        // An ICMP "port unreachable" for an earlier send is reported here once. The peer's watchdog handles it.
        if (size < 0 && (errno == ECONNREFUSED || errno == EINTR)) continue;
        if (size < 0 && announced_ > 0) {
            wait_for_announced();
            continue;
        }
        if (size < 0) {
            known_empty_ = watched_ || limit_ > Duration::zero();
            hears_outside_ = false;
            return {};
        }
        if (!from_peer(static_cast<std::size_t>(size))) continue;
        if (limit_ > Duration::zero() && of_session()) known_empty_ = --announced_ == 0;
        if (stamping_) arrival_ = arrival_clock_.arrival(kernel_stamp_ns(message));
        return {buffer_.data(), static_cast<std::size_t>(size)};
    }
    return {};
}

// In lock-step only the sending program's own ports count, which are bound while it lives.
bool UdpChannel::of_session() const {
    if (limit_ == Duration::zero()) return true;
    if (!knows(source_.sin_addr.s_addr)) return false;  // 127.0.0.1, where that port may be another user's
    const int place = ntohs(source_.sin_port) - base_port_;
    if (place < 0 || place >= static_cast<int>(kPortCount)) return false;
    const auto from = static_cast<Port>(place);
    if (from >= Port::kMasterHand && from <= Port::kPlayerMonitor) return false;  // free: no view takes part
    const Flow& heard = flow(listens_at_);
    return heard.from_all || owner(from) == heard.hears;
}

// Counts it. An empty datagram carries nothing.
bool UdpChannel::from_peer(std::size_t size) {
    const in_addr_t host = source_.sin_addr.s_addr;
    const bool also = known_loopback_ && host == htonl(INADDR_LOOPBACK);
    const bool known_host = peer_moves_ || also || knows(host);
    if (!known_host || !(hears_outside_ || of_session())) {
        ++counters_.foreign_source;
    } else if (size > kMaxDatagramBytes) {
        ++counters_.too_long;
    } else if (size > 0) {
        ++counters_.received;
        return true;
    }
    return false;
}

void UdpChannel::listen_also_to(const std::vector<std::string>& hosts) {
    for (const std::string& host : hosts) know(resolve({host, 0}).sin_addr.s_addr);
}

// A program at another address of 127.0.0.0/8 also sends from 127.0.0.1: the kernel gives that to an unbound socket.
void UdpChannel::know(in_addr_t host) {
    known_.push_back(host);
    known_loopback_ = known_loopback_ || is_loopback(ntohl(host));
}

bool UdpChannel::knows(in_addr_t host) const {
    return std::find(known_.begin(), known_.end(), host) != known_.end();
}

void UdpChannel::stamp_arrivals() { stamping_ = socket_.stamp_arrivals(); }

}  // namespace thimble
