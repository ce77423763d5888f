// How a relay names the random fates of its packets, and how it tells its log of those that never leave.
#pragma once

#include "common/random.hpp"
#include "netem/link_observer.hpp"
#include "netem/relay/packet_record.hpp"
#include "netem/relay/relay_engine.hpp"

namespace thimble {

// Part of every published seed, apart from the directions of a session (netem_settings.hpp).
inline constexpr std::uint32_t kRelayUp = 11, kRelayDown = 12;

// With the direction and the packet's number this decides a packet's fate.
inline StreamKey flow_key(std::uint64_t seed, std::uint32_t inlet, std::uint32_t flow) {
    StreamKey key;
    key.study = seed;
    key.experiment = inlet;
    key.subject = flow;
    return key;
}

inline LoggedFate fate_of(DropReason reason) {
    switch (reason) {
        case DropReason::kLost:
            return LoggedFate::kLost;
        case DropReason::kOutage:
            return LoggedFate::kOutage;
        case DropReason::kOversized:
            return LoggedFate::kOversized;
        case DropReason::kQueueFull:
            return LoggedFate::kQueueFull;
        case DropReason::kOverflowed:
            break;
    }
    return LoggedFate::kOverflowed;
}

// Links do not know whose they are: the engine says it before each push.
class RelayEngine::DropLog final : public LinkObserver {
  public:
    explicit DropLog(PacketSink& log) : log_(&log) {}

    void expect(const PacketRecord& record, std::size_t bytes) {
        record_ = record;
        record_.bytes = static_cast<std::uint32_t>(bytes);
    }
    void on_drop(std::uint64_t packet, SessionTime received, DropReason reason) override {
        record_.packet = packet;
        record_.received_ns = to_nanoseconds(received);
        record_.fate = fate_of(reason);
        log_->add(record_);
    }

  private:
    PacketSink* log_;
    PacketRecord record_;
};

}  // namespace thimble
