// The fate of packet n: lost, delayed, duplicated, corrupted or sent ahead; queues and timetables come later. A pure
// function of (key, direction, n) and the settings at its push.
#pragma once

#include <memory>
#include <span>

#include "netem/link_settings.hpp"
#include "netem/packet_trace.hpp"
#include "netem/stages/corrupt.hpp"
#include "netem/stages/jitter.hpp"
#include "netem/stages/loss.hpp"
#include "netem/stages/reorder.hpp"

namespace thimble {

struct PacketFate {
    bool lost = false;
    bool marked = false;  // would be lost, but says that it understands congestion marks
    bool corrupted = false;
    bool duplicated = false;
    bool skipped = false;  // goes without delay, before others
    Duration delay{};
    Duration copy_delay{};  // of the second copy

    bool operator==(const PacketFate&) const = default;
};

class LinkFates {
  public:
    LinkFates(const StreamKey& key, std::uint32_t direction);

    // `shape` is that of settings.jitter; both are made before, so that this allocates nothing. `settings` must stay
    // where they are.
    void configure(const LinkSettings& settings, const std::shared_ptr<const DelayShape>& shape);

    // Call it once per packet, in order. `time` since the start of the trial matters only for a trace by time. With
    // `may_mark` a packet is marked instead of lost.
    PacketFate decide(std::uint64_t packet, Duration time, bool may_mark = false);
    void flip_bits(std::uint64_t packet, std::span<std::uint8_t> bytes) { damage_.flip(packet, bytes); }

  private:
    Duration delayed(Duration mean, double deviate) const;

    const LinkSettings* settings_ = nullptr;
    Loss loss_;
    Jitter jitter_, copy_jitter_;
    Chance duplicate_, corrupt_;
    Corrupt damage_;
    Reorder reorder_;
};

}  // namespace thimble
