#include "thimble/link_test/port_probe.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <linux/errqueue.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "thimble/link_test/probe_packet.hpp"

namespace thimble {
namespace {

struct Ancillary {
    alignas(cmsghdr) std::array<std::uint8_t, 256> bytes;
};

msghdr message_into(iovec& part, Ancillary& room) {
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = room.bytes.data();
    message.msg_controllen = room.bytes.size();
    return message;
}

std::optional<sock_extended_err> error_in(const msghdr& message) {
    for (const cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr;
         c = CMSG_NXTHDR(const_cast<msghdr*>(&message), const_cast<cmsghdr*>(c))) {
        if (c->cmsg_level != IPPROTO_IP || c->cmsg_type != IP_RECVERR) continue;
        sock_extended_err error{};
        std::memcpy(&error, CMSG_DATA(c), sizeof error);
        return error;
    }
    return std::nullopt;
}

// Later than that, probes are left out: a burst of them would measure this machine, not the link.
constexpr Duration kStall = std::chrono::milliseconds{50};

}  // namespace

void forbid_fragments(const UdpSocket& socket) {
    const int probe = IP_PMTUDISC_PROBE;
    setsockopt(socket.descriptor(), IPPROTO_IP, IP_MTU_DISCOVER, &probe, sizeof probe);
}

std::optional<PortProbe::Received> PortProbe::receive() {
    for (;;) {
        iovec part{incoming_.data(), incoming_.size()};
        Ancillary room{};
        msghdr message = message_into(part, room);
        const auto size = recvmsg(socket_.descriptor(), &message, MSG_DONTWAIT);
        if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return std::nullopt;
        if (size < 0 && errno == EBADF) return std::nullopt;
        if (size < 0) continue;  // a pending error, told once; its cause lies in the error queue
        return Received{{incoming_.data(), static_cast<std::size_t>(size)},
                        clock_.arrival(kernel_stamp_ns(message))};
    }
}

void PortProbe::take_errors() {
    for (;;) {
        std::array<std::uint8_t, 64> offender{};
        iovec part{offender.data(), offender.size()};
        Ancillary room{};
        msghdr message = message_into(part, room);
        if (recvmsg(socket_.descriptor(), &message, MSG_ERRQUEUE | MSG_DONTWAIT) < 0) return;
        const auto error = error_in(message);
        if (!error) continue;
        evidence_.error = static_cast<int>(error->ee_errno);
        evidence_.by_icmp = error->ee_origin == SO_EE_ORIGIN_ICMP;
        evidence_.icmp_code = error->ee_code;
    }
}

PortProbe::PortProbe(const PortTraffic& traffic, const UdpAddress& remote, std::uint64_t asker)
    : traffic_(traffic),
      socket_(UdpSocket::connected(remote)),
      incoming_(kLargestProbeBytes),
      asker_(asker),
      room_(kLargestProbeBytes),
      period_(from_seconds(1 / traffic.rate_Hz)) {
    figures_.traffic = traffic;
    forbid_fragments(socket_);
    const int on = 1;
    setsockopt(socket_.descriptor(), IPPROTO_IP, IP_RECVERR, &on, sizeof on);
}

int PortProbe::send(ProbeKind kind, SessionTime now, std::uint32_t sequence, std::size_t bytes) {
    ProbePacket packet;
    packet.kind = kind;
    packet.port = static_cast<std::uint16_t>(traffic_.port);
    packet.nonce = kind == ProbeKind::kHello ? asker_ : nonce_;
    packet.sequence = sequence;
    packet.probe_sent = now;
    const std::span datagram = std::span(room_).first(std::max(bytes, kProbeHeaderBytes));
    write_probe(packet, datagram);
    const auto sent =
        ::send(socket_.descriptor(), datagram.data(), datagram.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    return sent < 0 ? errno : 0;
}

void PortProbe::say_hello(SessionTime now) {
    const int error = send(ProbeKind::kHello, now, static_cast<std::uint32_t>(asker_), traffic_.bytes);
    if (error == 0) return;
    ++complaints_;
    evidence_.error = error;
    take_errors();  // which may know more
}

int PortProbe::query(SessionTime now, std::size_t bytes) { return ask(query_, now, bytes); }

void PortProbe::follow(SessionTime now) {
    // A call may tell of the other's error instead of sending.
    if (ask(follower_, now, traffic_.bytes) != 0) ask(follower_, now, traffic_.bytes);
}

int PortProbe::ask(Query& query, SessionTime now, std::size_t bytes) {
    query = {++queries_, bytes};
    return send(ProbeKind::kQuery, now, query.sequence, bytes);
}

void PortProbe::start(SessionTime now) {
    started_ = next_due_ = last_echo_ = now;
    round_trip_.clear();
}

std::uint32_t PortProbe::send_due(SessionTime now) {
    std::uint32_t stalls = 0;
    if (now - next_due_ > kStall) {
        next_due_ = now;
        ++stalls;
    }
    for (; next_due_ <= now; next_due_ += period_) {
        const bool taken =
            send(ProbeKind::kProbe, now, figures_.sent + figures_.refused + 1, traffic_.bytes) == 0;
        ++(taken ? figures_.sent : figures_.refused);
    }
    return stalls;
}

void PortProbe::finish(SessionTime now) {
    next_due_ = kNever;
    ended_ = now;
    counting_ = true;
}

void PortProbe::take_all(std::vector<ClockExchange>& exchanges) {
    while (const auto received = receive()) {
        const auto packet = read_probe(received->bytes);
        if (packet && packet->port == static_cast<std::uint16_t>(traffic_.port))
            take(*packet, received->bytes.size(), received->arrived, exchanges);
    }
    const int before = evidence_.error;
    evidence_.error = 0;
    take_errors();
    if (evidence_.error != 0) {
        ++complaints_;
    } else {
        evidence_.error = before;
    }
}

void PortProbe::take(const ProbePacket& packet, std::size_t bytes, SessionTime arrived,
                     std::vector<ClockExchange>& exchanges) {
    if (packet.kind == ProbeKind::kWelcome) {
        if (packet.sequence != static_cast<std::uint32_t>(asker_)) return;
        nonce_ = packet.nonce;
        ++evidence_.welcomes;
        if (next_due_ == kNever) round_trip_.add(arrived - packet.probe_sent);
    }
    if (packet.nonce != nonce_) return;
    if (packet.kind == ProbeKind::kEcho) return take_echo(packet, arrived, exchanges);
    Query& answered = follower_.is(packet, bytes) ? follower_ : query_;
    if (packet.kind != ProbeKind::kCounts || !answered.is(packet, bytes)) return;
    answered.answered = true;
    take_counts(packet);
    counted_ = counting_;
}

void PortProbe::take_echo(const ProbePacket& echo, SessionTime arrived,
                          std::vector<ClockExchange>& exchanges) {
    take_counts(echo);
    if (!echoes_.add(echo.sequence)) return;
    round_trip_.add(arrived - echo.probe_sent);
    const bool first = echoes_.distinct() == 1;  // its way there and back is no pause
    longest_gap_ = std::max(longest_gap_, first ? echo.probe_sent - started_ : arrived - last_echo_);
    last_echo_ = arrived;
    const ClockExchange exchange{echo.probe_sent, echo.probe_arrived, echo.echo_sent, arrived};
    if (exchange.possible() && exchanges.size() < exchanges.capacity()) exchanges.push_back(exchange);
}

// Answers may overtake each other; counts only grow.
void PortProbe::take_counts(const ProbePacket& packet) {
    figures_.far_received = std::max(figures_.far_received, packet.far_received);
    figures_.far_duplicates = std::max(figures_.far_duplicates, packet.far_duplicates);
    figures_.far_reordered = std::max(figures_.far_reordered, packet.far_reordered);
    figures_.far_sent = std::max(figures_.far_sent, packet.far_sent);
}

PortFigures PortProbe::figures() const {
    PortFigures f = figures_;
    f.answer = classify(evidence_);
    f.counted = counted_;
    f.returned = echoes_.distinct();
    f.duplicates = echoes_.duplicates();
    f.reordered = echoes_.reordered();
    f.round_trip_median_s = to_seconds(round_trip_.quantile(0.5));
    f.round_trip_p99_s = to_seconds(round_trip_.quantile(0.99));
    f.round_trip_worst_s = to_seconds(round_trip_.worst());
    if (f.sent > 0) {
        f.seconds_s = to_seconds(ended_ - started_);
        f.longest_gap_s = to_seconds(std::max(longest_gap_, ended_ - last_echo_));
    }
    return f;
}

}  // namespace thimble
