#include "session/records/trial_table.hpp"

#include <algorithm>
#include <array>
#include <iterator>

namespace thimble {
namespace {

template <auto... Path>
constexpr TableColumn<TrialRow> in_row(std::string_view name) {
    return column<TrialRow, Path...>(name);
}

void write_outcome(fmt::memory_buffer& out, const TrialRow& row) {
    write_value(out, outcome_text(row.reason, row.lost_peer));
}

void read_outcome(const CsvField& field, TrialRow& row) {
    if (!parse_outcome(field.text, row.reason, row.lost_peer)) {
        field.fail(
            "is none of completed, timeout, interrupted, emergency_stop, peer_lost_<role>, "
            "device_fault_<role>, safety_stop_<role>");
    }
}

void write_compensator(fmt::memory_buffer& out, const TrialRow& row) {
    write_value(out, kCompensatorNames[static_cast<std::size_t>(row.conditions.compensator)]);
}

// A table of an earlier version has no such field, so its value is unknown.
void read_compensator(const CsvField& field, TrialRow& row) {
    if (field.text.empty()) return;
    const auto* const name = std::find(kCompensatorNames.begin(), kCompensatorNames.end(), field.text);
    if (name == kCompensatorNames.end())
        field.fail(fmt::format("is none of {}", fmt::join(kCompensatorNames, ", ")));
    row.conditions.compensator = static_cast<Compensator>(name - kCompensatorNames.begin());
}

using R = TrialRow;
using C = TrialConditions;
using M = TrialMetrics;

constexpr std::array kColumns{
    in_row<&R::conditions, &C::experiment>("experiment"),
    in_row<&R::conditions, &C::subject>("subject"),
    in_row<&R::conditions, &C::trial>("trial"),
    in_row<&R::conditions, &C::modality>("modality"),
    in_row<&R::conditions, &C::delay_s>("delay_s"),
    in_row<&R::conditions, &C::fixture_position_m>("fixture_position_m"),
    in_row<&R::metrics, &M::penetration_mean_m>("penetration_mean_m"),
    in_row<&R::metrics, &M::penetration_max_m>("penetration_max_m"),
    in_row<&R::metrics, &M::completion_time_s>("completion_time_s"),
    in_row<&R::metrics, &M::peak_displacement_m>("peak_displacement_m"),
    in_row<&R::metrics, &M::contacts_lost>("contacts_lost"),
    in_row<&R::metrics, &M::oscillation_rms_m>("oscillation_rms_m"),
    in_row<&R::metrics, &M::oscillation_peak_to_peak_m>("oscillation_peak_to_peak_m"),
    in_row<&R::metrics, &M::oscillation_frequency_Hz>("oscillation_frequency_Hz"),
    in_row<&R::metrics, &M::oscillates>("oscillates"),
    in_row<&R::metrics, &M::beeped>("beeped"),
    TableColumn<R>{"outcome", write_outcome, read_outcome},
    in_row<&R::conditions, &C::study_seed>("seed"),
    in_row<&R::conditions, &C::removes_fixture>("fixture_removed"),
    in_row<&R::delay_achieved_s>("delay_achieved_s"),
    in_row<&R::round_trip_s>("round_trip_s"),
    in_row<&R::metrics, &M::puncture_time_s>("puncture_time_s"),
    in_row<&R::metrics, &M::first_contact_time_s>("first_contact_time_s"),
    in_row<&R::metrics, &M::duration_s>("duration_s"),
    TableColumn<R>{"remedy", write_compensator, read_compensator},
};

constexpr auto kColumnNames = names_of(kColumns);

std::string header_line() { return fmt::format("{}\n", fmt::join(kColumnNames, ",")); }

std::vector<TrialRow> read_rows(CsvReader reader) {
    std::vector<TrialRow> rows;
    while (reader.next()) {
        TrialRow row;
        read_fields(reader, kColumns, row);
        rows.push_back(row);
    }
    return rows;
}

}  // namespace

TrialRow make_row(const TrialRecord& record) {
    return {record.conditions, measure(record),         record.reason,
            record.lost_peer,  record.achieved_delay_s, record.round_trip_s};
}

namespace {

template <class Keep>
std::vector<TrialRow> those_that(const std::vector<TrialRow>& rows, Keep&& keep) {
    std::vector<TrialRow> kept;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(kept), keep);
    return kept;
}

}  // namespace

std::vector<TrialRow> of_experiment(const std::vector<TrialRow>& rows, std::uint32_t experiment) {
    return those_that(rows, [&](const TrialRow& row) { return row.conditions.experiment == experiment; });
}

std::vector<TrialRow> without_removals(const std::vector<TrialRow>& rows) {
    return those_that(rows, [](const TrialRow& row) { return !row.conditions.removes_fixture; });
}

std::string outcome_text(EndReason reason, Role lost_peer) {
    const bool of_role = reason == EndReason::kPeerLost || reason == EndReason::kDeviceFault ||
                         reason == EndReason::kSafetyStop;
    if (!of_role) return to_string(reason);
    return fmt::format("{}_{}", to_string(reason), to_string(lost_peer));
}

bool parse_outcome(std::string_view text, EndReason& reason, Role& lost_peer) {
    for (const EndReason candidate : {EndReason::kNone, EndReason::kCompleted, EndReason::kTimeout,
                                      EndReason::kPeerLost, EndReason::kInterrupted, EndReason::kDeviceFault,
                                      EndReason::kSafetyStop, EndReason::kEmergencyStop}) {
        for (const Role role : {Role::kSession, Role::kMaster, Role::kSlaveSim, Role::kCutaneous,
                                Role::kVisual, Role::kNetem}) {
            if (text != outcome_text(candidate, role)) continue;
            reason = candidate;
            lost_peer = role;
            return true;
        }
    }
    return false;
}

std::span<const TableColumn<TrialRow>> trial_columns() { return kColumns; }

TrialTable::TrialTable(const std::filesystem::path& path, IfExists if_exists)
    : file_(path, if_exists, header_line()) {
    if (!file_.is_new()) {
        (void)CsvReader(path, kColumnNames, ',', 0,
                        LastLine::kMayBeTorn);  // of an earlier version: its lines would be shorter
        read_trial_table(path);                 // to append to a damaged table would hide the damage
        return;
    }
    file_.write(header_line());
    file_.sync();
}

void TrialTable::append(const TrialRow& row) {
    fmt::memory_buffer line;
    write_fields(line, kColumns, row);
    line.push_back('\n');
    file_.write({line.data(), line.size()});
    file_.sync();
}

std::vector<TrialRow> read_trial_table(const std::filesystem::path& path) {
    return read_rows(CsvReader(path, kColumnNames, ',', kLaterColumns));
}

std::vector<TrialRow> read_unfinished_trial_table(const std::filesystem::path& path) {
    return read_rows(CsvReader(path, kColumnNames, ',', 0, LastLine::kMayBeTorn));
}

}  // namespace thimble
