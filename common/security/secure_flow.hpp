// The two ends of a one-way flow, or of a hop of it, protected. Their keys come from the session (key_ring.hpp), for this alone.
#pragma once

#include "common/security/flow_roles.hpp"
#include "common/security/sealing.hpp"

namespace thimble {

constexpr PacketKind kind_of(const KeyedFlow& keyed) {
    return keyed.hop ? PacketKind::kHop : PacketKind::kData;
}

class SecureOutlet final : public Channel {
  public:
    // `wire` outlives it.
    SecureOutlet(Channel& wire, const KeyedFlow& keyed) : wire_(&wire), keyed_(keyed) {}

    void send(Bytes datagram) override {
        const Bytes sealed = sealer_.seal(kind_of(keyed_), keyed_.port, datagram);
        ++(sealed.empty() ? counters_.not_sent : counters_.sealed);
        if (!sealed.empty()) wire_->send(sealed);
    }
    const KeyedFlow& keyed() const { return keyed_; }
    Sealer& sealer() { return sealer_; }
    const SecurityCounters& counters() const { return counters_; }

  private:
    Bytes take() override { return {}; }

    Channel* wire_;
    KeyedFlow keyed_;
    Sealer sealer_;
    SecurityCounters counters_;
};

class SecureInlet final : public Channel {
  public:
    SecureInlet(Channel& wire, const KeyedFlow& keyed) : wire_(&wire), keyed_(keyed) {}

    void send(Bytes /*datagram*/) override { ++counters_.not_sent; }
    std::optional<SessionTime> arrival() const override { return wire_->arrival(); }
    const KeyedFlow& keyed() const { return keyed_; }
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
        } else if (header->port != keyed_.port || header->kind != kind_of(keyed_)) {
            ++counters_.wrong_role;
        } else if (Opener* const opener = openers_.find(*header); opener == nullptr) {
            ++counters_.no_key;
        } else if (const auto size = opener->open(*header, datagram, text_, counters_)) {
            return {text_.data(), *size};
        }
        return {};
    }

    Channel* wire_;
    KeyedFlow keyed_;
    OpenerPair openers_;
    SecurityCounters counters_;
    alignas(16) std::array<std::uint8_t, kMaxDatagramBytes> text_{};
};

}  // namespace thimble
