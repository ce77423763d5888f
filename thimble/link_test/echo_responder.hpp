// The far side of a link test, without sockets: which datagram gets which answer.
//
// Not usable for attacks. An answer is exactly as long as its request, and only a well-formed request gets one. Every
// request but a hello must carry the nonce that this host was given. So with a false address an attacker gets only
// short welcomes sent there, and answers per second are limited.
#pragma once

#include <array>
#include <atomic>
#include <bitset>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "common/flow.hpp"
#include "thimble/link_test/probe_packet.hpp"

namespace thimble {

// Counts the arrivals of a numbered sequence: distinct numbers, duplicates, and numbers that came after a later one.
class ArrivalCounter {
  public:
    // True for a number that is new. A number more than kWindow behind the newest counts as a duplicate, because its fate is unknown.
    bool add(std::uint32_t sequence) {
        const std::int32_t ahead = any_ ? sequence_ahead(sequence, newest_) : 1;
        if (ahead > 0) {
            forget(any_ ? static_cast<std::uint32_t>(ahead) : kWindow);
            newest_ = sequence;
            any_ = true;
        } else if (ahead <= -static_cast<std::int32_t>(kWindow) || seen_[sequence % kWindow]) {
            ++duplicates_;
            return false;
        } else {
            ++reordered_;
        }
        seen_[sequence % kWindow] = true;
        ++distinct_;
        return true;
    }

    std::uint32_t distinct() const { return distinct_; }
    std::uint32_t duplicates() const { return duplicates_; }
    std::uint32_t reordered() const { return reordered_; }

  private:
    static constexpr std::uint32_t kWindow = 1024;  // a power of two: numbers wrap

    void forget(std::uint32_t steps) {
        if (steps >= kWindow) {
            seen_.reset();
        } else {
            for (std::uint32_t i = 1; i <= steps; ++i) seen_[(newest_ + i) % kWindow] = false;
        }
    }

    std::bitset<kWindow> seen_;
    bool any_ = false;
    std::uint32_t newest_ = 0;
    std::uint32_t distinct_ = 0, duplicates_ = 0, reordered_ = 0;
};

struct EchoLimits {
    double answers_per_s = 50'000;             // not quite four times a session's whole traffic
    double hellos_per_s = 100;                 // an asker sends one to each of the ports at once
    Duration idle = std::chrono::seconds{10};  // after which a test's place is given away
};

struct EchoCounters {
    std::uint64_t begun = 0;  // tests that got a place
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

// `thimble link-test --listen`: an EchoResponder behind every UDP port of a session.
struct EchoPlan {
    std::uint16_t base_port = 0;
    std::vector<Port> ports;
    Duration limit = std::chrono::minutes{10};  // ends by itself
    const std::atomic<bool>* stop = nullptr;
};

// Until the limit or a stop. Throws Error (network) if a port is taken.
EchoCounters serve_echoes(const EchoPlan& plan);

}  // namespace thimble
