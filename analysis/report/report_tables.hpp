// The tables of a report, as text for people: millimetres, seconds, a dash for what does not exist.
#pragma once

#include <vector>

#include "analysis/text/html.hpp"
#include "session/records/condition_summary.hpp"
#include "session/records/trial_table.hpp"

namespace thimble {

// Peak to peak, rms, frequency and contacts lost during the hold.
ReportTable oscillation_table(const std::vector<ConditionSummary>& conditions);
// Penetration, completion time and, where the fixture was removed, peak displacement.
ReportTable metrics_table(const std::vector<ConditionSummary>& conditions);

// Tables for trials of real processes and of virtual time alike.
struct Agreement {
    ReportTable metrics;  // at 0 ms, where both should do the same
    ReportTable classes;  // at every delay: beyond the limit cycle's phase nothing else is comparable
    std::uint32_t compared = 0;
    std::uint32_t same_class = 0;
    std::uint32_t unmatched = 0;  // real trials without a counterpart, or that did not run to their end
};
Agreement compare_trials(const std::vector<TrialRow>& real, const std::vector<TrialRow>& in_virtual_time);

// A table per experiment and delay: of each measure the change with every ten trials, the differences of the modalities from the first
// one, and how much subjects differ. Empty where no group of trials can be judged.
std::vector<ReportTable> order_tables(const std::vector<TrialRow>& rows);

}  // namespace thimble
