// The far side of a link test, without sockets: which datagram gets which answer.
//
// Harmless by construction: an answer is exactly as long as what it answers, only a well-formed request is answered, anything
// but a hello must bear the nonce that this host was given (so nobody can have answers sent to somebody else but short
// welcomes, and those are few), and the number of answers per second is limited.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "thimble/link_test/arrival_counter.hpp"
#include "thimble/link_test/port_traffic.hpp"
#include "thimble/link_test/probe_packet.hpp"

namespace thimble {

struct EchoLimits {
    double answers_per_s = 50'000;             // a session's whole traffic five times
    double hellos_per_s = 100;                 // an asker sends one to each of the ports at once
    Duration idle = std::chrono::seconds{10};  // after which a test's place is given away
};

struct EchoCounters {
    std::uint64_t answered = 0;
    std::uint64_t malformed = 0;    // not a request of this protocol
    std::uint64_t wrong_port = 0;   // meant for another port than it came to
    std::uint64_t wrong_nonce = 0;  // of no host, or of another one
    std::uint64_t limited = 0;      // more than the limits allow
    std::uint64_t crowded = 0;      // hellos while all places were taken
};

// Tokens that come back at a steady rate, `most` of them at a time.
class RateLimit {
  public:
    RateLimit(double per_s, double most) : per_s_(per_s), most_(most), tokens_(most) {}
    bool take(SessionTime now);

  private:
    double per_s_, most_, tokens_;
    SessionTime filled_{};
};

class EchoResponder {
  public:
    using Draw = std::function<std::uint64_t()>;  // nonces, which must not be guessed
    EchoResponder(const EchoLimits& limits, Draw draw);

    // `host`: the asker's address; `port`: offset at which the request came; `arrived`: when, on this machine's clock.
    // Writes the answer over the request and returns true, or leaves it unanswered.
    bool answer(SessionTime now, SessionTime arrived, std::uint32_t host, std::uint16_t port,
                std::span<std::uint8_t> datagram);

    const EchoCounters& counters() const { return counters_; }
    std::size_t tests() const;  // that have a place

  private:
    struct PortCount {
        ArrivalCounter arrivals;
        std::uint32_t sent = 0;
    };
    struct Test {
        bool taken = false;
        std::uint32_t host = 0;
        std::uint64_t asker = 0;  // what its hello said
        std::uint64_t nonce = 0;
        SessionTime heard{};
        std::array<PortCount, kPortCount> ports;
    };

    Test* welcome(SessionTime now, std::uint32_t host, std::uint64_t asker);
    Test* find(std::uint32_t host, std::uint64_t nonce);
    Test* admit(SessionTime now, std::uint32_t host, const ProbePacket& request);
    static ProbePacket reply(const ProbePacket& request, Test& test, SessionTime now, SessionTime arrived);

    EchoLimits limits_;
    Draw draw_;
    RateLimit answers_, hellos_;
    std::array<Test, 8> tests_;
    EchoCounters counters_;
};

}  // namespace thimble
