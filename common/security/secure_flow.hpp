// The two ends of a one-way flow, protected. Their keys come from the session (key_ring.hpp), for this flow alone.
#pragma once

#include "common/security/sealing.hpp"

namespace thimble {

class SecureOutlet final : public Channel {
  public:
    // `wire` outlives it; `port` is the flow's final one.
    SecureOutlet(Channel& wire, Port port) : wire_(&wire), port_(port) {}

    void send(Bytes datagram) override {
        const Bytes sealed = sealer_.seal(PacketKind::kData, port_, datagram);
        ++(sealed.empty() ? counters_.not_sent : counters_.sealed);
        if (!sealed.empty()) wire_->send(sealed);
    }
    Port port() const { return port_; }
    Sealer& sealer() { return sealer_; }
    const SecurityCounters& counters() const { return counters_; }

  private:
    Bytes take() override { return {}; }

    Channel* wire_;
    Port port_;
    Sealer sealer_;
    SecurityCounters counters_;
};

class SecureInlet final : public Channel {
  public:
    SecureInlet(Channel& wire, Port port) : wire_(&wire), port_(port) {}

    void send(Bytes /*datagram*/) override { ++counters_.not_sent; }
    std::optional<SessionTime> arrival() const override { return wire_->arrival(); }
    Port port() const { return port_; }
    OpenerPair& openers() { return openers_; }
    const SecurityCounters& counters() const { return counters_; }

  private:
    Bytes take() override {
        return receive_judged(*wire_, [this](Bytes datagram) { return open(datagram); });
    }

    Bytes open(Bytes datagram) {
        const auto header = read_seal_header(datagram);
        if (!header) {
            ++counters_.unsealed;
        } else if (header->port != port_ || header->kind != PacketKind::kData) {
            ++counters_.wrong_role;
        } else if (Opener* const opener = openers_.find(*header); opener == nullptr) {
            ++counters_.no_key;
        } else if (const auto size = opener->open(*header, datagram, text_, counters_)) {
            return {text_.data(), *size};
        }
        return {};
    }

    Channel* wire_;
    Port port_;
    OpenerPair openers_;
    SecurityCounters counters_;
    alignas(16) std::array<std::uint8_t, kMaxDatagramBytes> text_{};
};

}  // namespace thimble
