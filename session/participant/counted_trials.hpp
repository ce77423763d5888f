// Which trials of a dataset an analysis may use, and why it may not use the others.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "session/participant/dataset.hpp"
#include "session/records/trial_table.hpp"

namespace thimble {

enum class LeftOut : std::uint8_t { kPractice, kExcluded, kRejected, kSuperseded, kFailed };
const char* to_string(LeftOut why);

struct LeftOutTrial {
    LeftOut why = LeftOut::kFailed;
    std::uint32_t participant = 0, position = 0, record = 0;
    std::string reason;  // the experimenter's, or the outcome
};

struct CountedTrials {
    std::vector<TrialRow> rows;  // one per trial of an order at most
    std::vector<LeftOutTrial> left_out;
    std::size_t participants = 0, records = 0;
    std::size_t missing = 0;  // trials of the orders without a row that counts, practice aside
};

// A record counts unless it is practice, excluded, rejected, superseded by a repeat, or failed (interrupted
// or a peer lost). Throws Error (data) if a file cannot be read.
CountedTrials counted_trials(const Dataset& dataset);

// In words, a line each.
std::vector<std::string> describe(const CountedTrials& trials);

}  // namespace thimble
