#include "thimble/link_test/echo_responder.hpp"

#include <algorithm>
#include <utility>

namespace thimble {
namespace {

// A hello may come under a false address: its answer is kept short.
bool asks(const ProbePacket& packet, std::size_t bytes) {
    return (packet.kind == ProbeKind::kHello && bytes <= kMaxDatagramBytes) ||
           packet.kind == ProbeKind::kProbe || packet.kind == ProbeKind::kQuery;
}

}  // namespace

bool RateLimit::take(SessionTime now) {
    tokens_ = std::min(most_, tokens_ + per_s_ * to_seconds(std::max(now - filled_, Duration{})));
    filled_ = now;
    if (tokens_ < 1) return false;
    tokens_ -= 1;
    return true;
}

EchoResponder::EchoResponder(const EchoLimits& limits, Draw draw)
    : limits_(limits),
      draw_(std::move(draw)),
      answers_(limits.answers_per_s, limits.answers_per_s / 10),
      hellos_(limits.hellos_per_s, limits.hellos_per_s / 2) {}

EchoResponder::Test* EchoResponder::find(std::uint32_t host, std::uint64_t nonce) {
    const auto found = std::find_if(tests_.begin(), tests_.end(), [&](const Test& test) {
        return test.taken && test.host == host && test.nonce == nonce;
    });
    return found == tests_.end() ? nullptr : &*found;
}

// Each asker has a slot. A new asker takes that of one that has been silent for long.
EchoResponder::Test* EchoResponder::welcome(SessionTime now, std::uint32_t host, std::uint64_t asker) {
    auto place = std::find_if(tests_.begin(), tests_.end(), [&](const Test& test) {
        return test.taken && test.host == host && test.asker == asker;
    });
    if (place != tests_.end()) return &*place;
    place = std::find_if(tests_.begin(), tests_.end(),
                         [&](const Test& test) { return !test.taken || now - test.heard > limits_.idle; });
    if (place == tests_.end()) return nullptr;
    ++counters_.begun;
    *place = Test{true, host, asker, draw_(), now, {}};
    return &*place;
}

EchoResponder::Test* EchoResponder::admit(SessionTime now, std::uint32_t host, const ProbePacket& request) {
    const bool hello = request.kind == ProbeKind::kHello;
    if (hello && !hellos_.take(now)) {
        ++counters_.limited;
        return nullptr;
    }
    Test* test = hello ? welcome(now, host, request.nonce) : find(host, request.nonce);
    if (test == nullptr) {
        ++(hello ? counters_.crowded : counters_.wrong_nonce);
    } else if (!answers_.take(now)) {
        ++counters_.limited;
        return nullptr;
    }
    return test;
}

ProbePacket EchoResponder::reply(const ProbePacket& request, Test& test, SessionTime now,
                                 SessionTime arrived) {
    PortCount& port = test.ports[request.port];
    ProbePacket answer = request;
    answer.kind = static_cast<ProbeKind>(static_cast<std::uint8_t>(request.kind) + 1);
    answer.nonce = test.nonce;
    if (request.kind == ProbeKind::kProbe) {
        port.arrivals.add(request.sequence);
        ++port.sent;
    }
    answer.far_received = port.arrivals.distinct();
    answer.far_duplicates = port.arrivals.duplicates();
    answer.far_reordered = port.arrivals.reordered();
    answer.far_sent = port.sent;
    answer.probe_arrived = arrived;
    answer.echo_sent = now;
    return answer;
}

bool EchoResponder::answer(SessionTime now, SessionTime arrived, std::uint32_t host, std::uint16_t port,
                           std::span<std::uint8_t> datagram) {
    const auto request = read_probe(datagram);
    if (!request || !asks(*request, datagram.size())) {
        ++counters_.malformed;
        return false;
    }
    if (request->port != port || port >= kPortCount) {
        ++counters_.wrong_port;
        return false;
    }
    Test* test = admit(now, host, *request);
    if (test == nullptr) return false;
    test->heard = now;
    write_probe(reply(*request, *test, now, arrived), datagram);
    ++counters_.answered;
    return true;
}

}  // namespace thimble
