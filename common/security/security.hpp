// All that one program protects: its channels with a way back, its ends of one-way flows, and the keys of both. Pure: `now` is an
// argument, randomness is handed in.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/process.hpp"
#include "common/security/key_ring.hpp"
#include "common/security/stop_seal.hpp"

namespace thimble {

class Security {
  public:
    Security(std::shared_ptr<const LabKey> lab, RandomBytes random, const SecurityTimes& times = {});

    // Each returns what protects `wire`, which outlives this. The relay's are hops: it takes off and puts on their seal, and
    // has no key of the flow within. An outlet is never the first: the ports of the others say whose program this is.
    Channel* pair(Channel& wire, Port local, Port remote);
    Channel* inlet(Channel& wire, Port local);
    Channel* outlet(Channel& wire, Port remote);
    // `port` and `end`: as StopSeal has them.
    Channel* stop_end(Channel& wire, std::uint16_t port, StopEnd end);

    // Before and after whatever sends and receives through it, at the same `now`.
    void tick(SessionTime now);
    SessionTime next_wakeup() const;

    // A node: it can speak with the session. The session: each node has all its keys.
    bool complete() const;
    SecurityCounters counters() const;
    // The peers with another key or none, as far as this end hears them: "" or a text with advice.
    std::string complaint() const;

  private:
    Channel* add_inlet(Channel& wire, const KeyedFlow& keyed);
    Channel* add_outlet(Channel& wire, const KeyedFlow& keyed);
    std::string peers_with(PairTrouble trouble) const;

    std::shared_ptr<const LabKey> lab_;
    RandomBytes random_;
    SecurityTimes times_;
    std::optional<Role> self_;
    TickTimes ticks_;
    FlowEnds ends_;
    std::vector<std::unique_ptr<SecurePair>> pairs_;
    std::vector<std::unique_ptr<SecureInlet>> inlets_;
    std::vector<std::unique_ptr<SecureOutlet>> outlets_;
    std::vector<std::unique_ptr<StopSeal>> stop_ends_;
    std::unique_ptr<KeyRing> ring_;
    std::unique_ptr<KeyServer> server_;
};

// A process whose channels are protected; both outlive it.
class SecuredProcess final : public Process {
  public:
    SecuredProcess(Process& process, Security& security) : process_(&process), security_(&security) {}

    void tick(SessionTime now) override {
        security_->tick(now);
        process_->tick(now);
        security_->tick(now);
    }
    SessionTime next_wakeup() const override {
        return std::min(process_->next_wakeup(), security_->next_wakeup());
    }
    bool stopped() const override { return process_->stopped(); }

  private:
    Process* process_;
    Security* security_;
};

}  // namespace thimble
