// The findings of any table of trials: which conditions oscillate, and how far each two differ. Groups are an experiment at a
// delay. One procedure per comparison: estimate, interval and P come from the same rank test (location_shift.hpp).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "analysis/tables/comparisons.hpp"
#include "analysis/text/html.hpp"

namespace thimble {

struct OscillationShare {
    std::string condition;                       // "HF", of several compensators "HF+wave"
    std::size_t subjects = 0;                    // with a judged trial
    std::size_t trials = 0, oscillating = 0;     // judged: ran to their end and touched the fixture
    std::optional<ConfidenceInterval> interval;  // of the share of trials, Wilson's; nothing without a trial

    bool mostly() const { return 2 * oscillating > trials; }
};

struct GroupFindings {
    std::uint32_t experiment = 3;
    double delay_s = 0;
    std::vector<OscillationShare> oscillations;
    std::vector<ConditionPair> comparisons;
    // Conditions that have trials, but not one value of this measure. Another condition has values of it.
    std::vector<std::pair<std::string, Metric>> unmeasured;
    std::string name;  // "50 ms"; with several experiments "50 ms in experiment 3"
};

// By experiment, then delay. Trials that did not run to their end are left out.
std::vector<GroupFindings> findings_of(const std::vector<TrialRow>& rows);

// "At 50 ms HF oscillates in 58 of 60 trials (...)."
std::string words(const OscillationShare& share, const GroupFindings& group);
// "HF was 6.1 mm deeper than CF in maximum penetration at 50 ms (...)."
std::string words(const ConditionPair& comparison, const GroupFindings& group);

// Parts of sentences.
std::string name_of(Metric metric);                            // "maximum penetration"
std::string difference_text(const ConditionPair& comparison);  // "HF was 6.1 mm deeper than CF"
std::string interval_text(const ConditionPair& comparison);  // "4.9 to 7.4 mm", in the direction of that text
std::string counted(std::size_t n, const std::string& thing);  // "1 subject", "2 subjects"
std::string list_text(const std::vector<std::string>& names);  // "HF, CF and VF"

// Three sentences: which conditions oscillate, how modalities differ, what cannot be said.
std::vector<std::string> answer(const std::vector<GroupFindings>& groups);

// Oscillations and comparisons as shown to people; a table without rows is left out.
std::vector<ReportTable> finding_tables(const std::vector<GroupFindings>& groups);

// A list of objects comparison, n, difference, interval, P, words; SI units, null where nothing can be said.
nlohmann::ordered_json to_json(const std::vector<GroupFindings>& groups);
// Replaces the file; throws Error (run failed) if it cannot be written.
void write_findings(const std::vector<GroupFindings>& groups, const std::filesystem::path& json);

}  // namespace thimble
