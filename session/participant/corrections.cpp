#include "session/participant/corrections.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"
#include "session/participant/dataset.hpp"
#include "session/participant/order_file.hpp"
#include "session/participant/record_table.hpp"
#include "session/participant/tsv.hpp"

namespace thimble {
namespace {

constexpr std::array<std::string_view, 7> kColumns{"time_utc", "by",    "participant_id", "item",
                                                   "before",   "after", "reason"};

Dataset dataset_in(const std::filesystem::path& folder) {
    Dataset dataset(folder);
    if (dataset.kind()) return dataset;
    throw Error(ExitCode::kUsage,
                "{}: is not a dataset of participants; name the --out folder of a participant session",
                folder.string());
}

std::uint32_t participant_named(const std::string& name) {
    const auto participant = parse_participant(name);
    if (!participant)
        throw Error(ExitCode::kUsage, "{}: is not a participant; write P and a number, e.g. P07", name);
    return *participant;
}

// The newest record of a trial.
DatasetRecord record_at(const Dataset& dataset, const std::string& name, std::uint32_t position) {
    const auto file = dataset.records(participant_named(name));
    const auto records = read_records(file);
    const auto last = std::find_if(records.rbegin(), records.rend(),
                                   [&](const DatasetRecord& record) { return record.position == position; });
    if (last != records.rend()) return *last;
    throw Error(ExitCode::kUsage, "{} has no record of trial {}: see column 'position' of {}", name, position,
                file.string());
}

void write_note(const Dataset& dataset, std::uint32_t participant, const std::string& item,
                const std::string& before, const std::string& after, const CorrectionNote& note) {
    if (tsv_text(note.reason) == kNotAvailable)
        throw Error(ExitCode::kUsage, "data are changed only with a reason: give --reason");
    const std::array<std::string, 7> fields{
        note.time_utc, tsv_text(note.by),    participant_id(participant), item, before,
        after,         tsv_text(note.reason)};
    TsvFile(dataset.corrections(), kColumns).append(fmt::format("{}", fmt::join(fields, "\t")));
}

// A trial may be included and still not count. One that was run again counts as its repeat: nothing brings the replaced record back.
std::string why_already(const Exclusion* there, const DatasetRecord& record) {
    if (there != nullptr) return ": " + there->reason;
    if (record.practice) return ", but practice never counts";
    if (record.row.conditions.trial >= kFirstAttentionTrial)
        return ", but the statistics leave out attention trials";
    if (!ran_to_its_end(record.row))
        return fmt::format(", but it ended as {} and so does not count",
                           outcome_text(record.row.reason, record.row.lost_peer));
    if (record.repeat_of == 0) return {};
    return fmt::format(": record {} was run instead of record {}, which stays left out", record.record,
                       record.repeat_of);
}

void mark(const std::filesystem::path& folder, const std::string& name, std::uint32_t position,
          ExclusionKind kind, const CorrectionNote& note) {
    const Dataset dataset = dataset_in(folder);
    const TurnLock lock(dataset.description());
    const DatasetRecord record = record_at(dataset, name, position);
    const std::uint32_t participant = participant_named(name);
    const auto exclusions = read_exclusions(dataset.exclusions(), LastLine::kMayBeTorn);
    const Exclusion* there = find_exclusion(exclusions, participant, record.record);
    const std::string before = there == nullptr ? "included" : to_string(there->kind);
    if (before == to_string(kind))
        throw Error(ExitCode::kUsage, "trial {} of {} is {} already{}", position, name, before,
                    why_already(there, record));
    write_note(dataset, participant, fmt::format("trial {} (record {})", position, record.record), before,
               to_string(kind), note);
    add_exclusion(dataset.exclusions(), {participant, position, record.record, kind, note.reason});
}

// As the options of thimble run take it.
std::string checked(const std::string& column, const std::string& value) {
    using Values = std::vector<std::string>;
    if (column == "age") return age_text(value);
    const Values allowed = column == "sex"                 ? Values{"M", "F", "O", "n/a"}
                           : column == "handedness"        ? Values{"left", "right", "ambidextrous", "n/a"}
                           : column == "haptic_experience" ? Values{"none", "some", "expert", "n/a"}
                                                           : Values{};
    if (allowed.empty())
        throw Error(ExitCode::kUsage, "{}: can be age, sex, handedness or haptic_experience", column);
    if (std::find(allowed.begin(), allowed.end(), value) != allowed.end()) return value;
    throw Error(ExitCode::kUsage, "{} {}: must be {}", column, value, fmt::join(allowed, ", "));
}

}  // namespace

void exclude_trial(const std::filesystem::path& folder, const std::string& name, std::uint32_t position,
                   const CorrectionNote& note) {
    mark(folder, name, position, ExclusionKind::kExcluded, note);
}

void include_trial(const std::filesystem::path& folder, const std::string& name, std::uint32_t position,
                   const CorrectionNote& note) {
    mark(folder, name, position, ExclusionKind::kIncluded, note);
}

std::string correct_person(const std::filesystem::path& folder, const std::string& name,
                           const std::string& column, const std::string& given, const CorrectionNote& note) {
    const Dataset dataset = dataset_in(folder);
    const std::uint32_t participant = participant_named(name);
    std::string value = checked(column, given);
    const std::string before = person_field(dataset, participant, column);
    if (before == value) throw Error(ExitCode::kUsage, "{} of {} is {} already", column, name, value);
    write_note(dataset, participant, column, before, value, note);
    set_person_field(dataset, participant, column, value);
    return value;
}

std::size_t count_corrections(const std::filesystem::path& file) {
    std::size_t lines = 0;
    if (!is_table(file)) return lines;
    CsvReader reader(file, kColumns, '\t');
    while (reader.next()) ++lines;
    return lines;
}

}  // namespace thimble
