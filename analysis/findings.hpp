// The findings of any table of trials: which conditions oscillate, and how far each two differ. Groups are an experiment at a
// delay. One procedure per comparison: estimate, interval and P come from the same rank test (location_shift.hpp).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "analysis/statistics/location_shift.hpp"
#include "analysis/tables/study_columns.hpp"
#include "analysis/text/html.hpp"

namespace thimble {

// Of P; intervals hold with 1 minus it. Both are for all pairs of one measure and group at once (Bonferroni).
inline constexpr double kFindingLevel = 0.05;

struct OscillationShare {
    std::string condition;                       // "HF", of several compensators "HF+wave"
    std::size_t subjects = 0;                    // with a judged trial
    std::size_t trials = 0, oscillating = 0;     // judged: ran to their end and touched the fixture
    std::optional<ConfidenceInterval> interval;  // of the share of trials, Wilson's; nothing without a trial

    bool mostly() const { return 2 * oscillating > trials; }
};

struct Comparison {
    Metric metric = Metric::kPenetrationMean;
    std::string first, second;
    std::size_t n = 0;                   // subjects with both; of independent trials: trials of both together
    std::size_t subjects = 0;            // of those
    std::size_t family = 1;              // pairs compared at once
    bool paired = true;                  // false: independent trials (experiment 2)
    std::optional<LocationShift> shift;  // nothing if n is 0

    bool can_be_judged() const { return shift && shift->interval; }
    bool apart() const { return can_be_judged() && shift->p < kFindingLevel; }
    std::size_t fewest() const;  // subjects, or trials of each condition, with which it can be judged
};

struct GroupFindings {
    std::uint32_t experiment = 3;
    double delay_s = 0;
    std::vector<OscillationShare> oscillations;
    std::vector<Comparison> comparisons;
    std::string name;  // "50 ms"; with several experiments "50 ms, experiment 3"
};

// By experiment, then delay. Trials that did not run to their end are left out.
std::vector<GroupFindings> find(const std::vector<TrialRow>& rows);

// "HF was 6.1 mm deeper than CF in maximum penetration at 50 ms (...)."
std::string words(const OscillationShare& share, const GroupFindings& group);
std::string words(const Comparison& comparison, const GroupFindings& group);
// "6.1 mm deeper than"; the size of the difference without its sign.
std::string difference_text(const Comparison& comparison);
// "4.9 to 7.4 mm", in the direction that difference_text() has; nothing is judged: empty.
std::string interval_text(const Comparison& comparison);
std::string name_of(Metric metric);                       // "maximum penetration"
std::string list_text(const std::vector<std::string>& names);  // "HF, CF and VF"

// Three sentences: which conditions oscillate, how modalities differ, what cannot be said.
std::vector<std::string> answer(const std::vector<GroupFindings>& groups);

// Oscillations and comparisons as shown to people; those without rows are left out.
std::vector<ReportTable> finding_tables(const std::vector<GroupFindings>& groups);

// A list of objects comparison, n, difference, interval, P, words; SI units, null where nothing can be said.
nlohmann::ordered_json to_json(const std::vector<GroupFindings>& groups);
// Replaces the file; throws Error (run failed) if it cannot be written.
void write_findings(const std::vector<GroupFindings>& groups, const std::filesystem::path& json);

}  // namespace thimble
