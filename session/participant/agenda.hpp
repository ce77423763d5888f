// The next step of a participant session, as a pure function of its files. So a session goes on after any interruption.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "session/participant/order_file.hpp"
#include "session/participant/record_table.hpp"
#include "session/settings/protocol_settings.hpp"

namespace thimble {

struct Step {
    OrderEntry entry;
    std::uint32_t repeat_of = 0;  // 0: for the first time
    std::string reason;           // of the repeat
};

struct Agenda {
    std::vector<OrderEntry> order;
    std::vector<DatasetRecord> records;
    std::vector<Exclusion> exclusions;  // of all participants
    std::uint32_t participant = 0;

    // The first block with something to do: trials that have no record, and those to be repeated, which come
    // at the end of the block or at their place. Nothing when the participant session is complete.
    //
    // A trial is repeated if its last record was rejected or interrupted, or ended by an emergency stop. At most
    // repeats_limit times it is repeated after a lost peer, a device fault, a safety stop or a time-out. A time-out
    // repeats no practice and no attention trial, and nothing if repeat_timeouts is false. Nothing repeats an
    // excluded record.
    std::optional<Step> next(const ProtocolSettings& settings) const;

    // Trials of the order that have a record. With it, how far the participant is.
    std::size_t begun() const;
};

}  // namespace thimble
