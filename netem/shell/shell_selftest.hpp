// The path of a pair for the self-test: two rooms without programs, and two links between their devices.
#pragma once

#include <optional>

#include "netem/relay/selftest.hpp"
#include "netem/shell/packet_relay.hpp"
#include "netem/shell/program_room.hpp"

namespace thimble {

class ShellPath final : public SelftestPath {
  public:
    // Before there are other threads. Throws Error as ProgramRoom does.
    ShellPath();
    int server() const override { return server_.socket(); }
    void open(const SelftestSettings& settings, bool precise, PacketSink& records) override;
    int client() override;
    void step(SessionTime latest) override { relay_->step(latest); }
    RelayState state(SessionTime now) const override { return relay_->state(now); }
    SessionTime start() const override { return relay_->start(); }
    SessionTime opened(SessionTime /*first_packet*/) const override { return relay_->start(); }
    std::size_t header_bytes() const override { return 28; }  // of IPv4 and UDP
    bool drops_corrupted() const override { return true; }

  private:
    ProgramRoom client_, server_;
    std::optional<PacketRelay> relay_;
};

}  // namespace thimble
