// A path from two captures of the same traffic, one near the sender, one near the receiver.
#pragma once

#include <cstdint>
#include <optional>

#include "netem/formats/capture_file.hpp"
#include "netem/formats/measured_path.hpp"

namespace thimble {

struct CapturePairOptions {
    // Destination ports, where a capture holds more than the one flow: a relay or an address translation between the
    // two may change them.
    std::optional<std::uint16_t> sent_port{}, received_port{};
    // Moves all delays so that the least is this one: for clocks that are not synchronised.
    std::optional<Duration> least_delay{};
};

struct CapturePair {
    MeasuredPath path;
    std::size_t sent = 0, received = 0;  // datagrams looked at
    std::size_t lost = 0;
    std::size_t duplicates = 0;  // received more often than sent
    std::size_t reordered = 0;   // received after one that was sent later (RFC 4737)
    std::size_t ambiguous =
        0;  // equal payloads sent more than once, not all received: which was lost is a guess
    std::size_t foreign = 0;   // received, but never sent
    Duration least{}, most{};  // delays as the stamps have them, before any move
};

// Datagrams are the same if payload and length are; equal ones are matched in their order. Throws Error (data) if
// nothing matches, or if a delay is below 0 and options.least_delay does not say what to do about it.
CapturePair match_captures(const Capture& sent, const Capture& received, const CapturePairOptions& options);

}  // namespace thimble
