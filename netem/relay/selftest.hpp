// Checks that this machine can emulate a network accurately: own traffic through an own path, compared with the
// settings and with this machine's bare timer. Findings are data; the verdict is arithmetic on them (verdict()).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <boost/core/noncopyable.hpp>
#include <nlohmann/json.hpp>

#include "common/histogram.hpp"
#include "common/runtime/runtime_settings.hpp"
#include "netem/relay/packet_record.hpp"
#include "netem/relay/relay_report.hpp"
#include "netem/relay/relay_settings.hpp"
#include "netem/relay/selftest_twin.hpp"

namespace thimble {

struct SelftestSettings {
    LinkPair links;
    TimelinePair timelines;
    std::uint64_t seed = 1;
    Duration length = std::chrono::seconds{10};  // at least one; a fifth of it goes to the bare timer
    bool precise = false;
    RuntimeSettings runtime;
};

struct SelftestDirection {
    std::uint64_t offered = 0;      // sent by the traffic
    std::uint64_t received = 0;     // by the relay
    std::uint64_t arrived = 0;      // first copies, unharmed, at the other end
    std::uint64_t dropped = 0;      // by the link, as asked
    std::uint64_t lost = 0;         // of these by its loss model, or a trace
    std::uint64_t corrupted = 0;    // left with bits flipped; the kernel may refuse such a packet
    std::uint64_t early = 0;        // sent before they were due
    std::uint64_t other_fates = 0;  // dropped where virtual time with this seed does not, or the reverse
    // Losses that neither settings nor statistics explain: before, in or after the relay.
    std::uint64_t lost_by_machine = 0;
    double lost_mean = 0;    // over all seeds
    double lost_chance = 1;  // share of seeds that lose a number as far out (LossLaw::chance_of)
    Comparison comparison;
    std::vector<double> delays_s;  // achieved, from send to the kernel's stamp at the other end, sorted
};

enum class SelftestVerdict { kPass, kMarginal, kFail };
std::string_view to_string(SelftestVerdict verdict);

struct SelftestResult {
    RelayState state;
    std::array<SelftestDirection, 2> direction;  // RelayDirection
    Histogram timer;                             // bare, before and after the traffic
    SelftestVerdict verdict = SelftestVerdict::kPass;
    std::vector<std::string> causes;  // of a verdict that is not PASS
};

// Computes verdict and causes from the other fields.
void judge(SelftestResult& result);

// The way that the traffic goes, and its two ends.
class SelftestPath : boost::noncopyable {
  public:
    virtual ~SelftestPath() = default;
    virtual int server() const = 0;  // a socket that stamps what comes
    // Two links and what relays for them, with the scheduling that this thread has now.
    virtual void open(const SelftestSettings& settings, bool precise, PacketSink& records) = 0;
    // From then on:
    virtual int client() = 0;  // a socket that is connected to the server, through the path
    virtual void step(SessionTime latest) = 0;
    virtual RelayState state(SessionTime now) const = 0;
    virtual SessionTime start() const = 0;
    // A link begins with its first packet, or with the path.
    virtual SessionTime opened(SessionTime first_packet) const = 0;
    virtual std::size_t header_bytes() const { return 0; }  // that a link counts beyond a datagram's own
    virtual bool drops_corrupted() const { return false; }  // the receiving kernel does, by their checksums
};

// Throws Error (network) if loopback UDP cannot be used.
std::unique_ptr<SelftestPath> make_relay_path();
// How long the last packets may be on their way, there and back. Throws Error (usage) if that is too long to wait for.
Duration selftest_drain(const SelftestSettings& settings, std::size_t header_bytes);
SelftestResult run_selftest(const SelftestSettings& settings, SelftestPath& path);

nlohmann::ordered_json describe(const SelftestResult& result);
std::string selftest_text(const SelftestResult& result);

}  // namespace thimble
