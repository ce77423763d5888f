// Changes of a participant's data after the session. Each leaves a line in corrections.tsv first: when, who, what, before, after, why.
// Lines of that file and of exclusions.tsv are only ever added.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace thimble {

struct CorrectionNote {
    std::string by;        // who decides; no participant's name
    std::string reason;    // never empty
    std::string time_utc;  // utc_text()
};

// These throw Error and then write nothing. Usage: no dataset, participant or trial of that name, nothing would change, or a value that
// the column does not have. Data: a file of the dataset is damaged.

// By its position in the order: the trial's newest record is left out of the analysis.
void exclude_trial(const std::filesystem::path& folder, const std::string& participant,
                   std::uint32_t position, const CorrectionNote& note);
// Takes back that it was excluded, or rejected and not run again.
void include_trial(const std::filesystem::path& folder, const std::string& participant,
                   std::uint32_t position, const CorrectionNote& note);
// A field of participants.tsv: age, sex, handedness or haptic_experience. Returns the value as written: an age of 95 is "89+".
std::string correct_person(const std::filesystem::path& folder, const std::string& participant,
                           const std::string& column, const std::string& value, const CorrectionNote& note);

// How many lines corrections.tsv has. Throws Error (data).
std::size_t count_corrections(const std::filesystem::path& file);

}  // namespace thimble
