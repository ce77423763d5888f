#include "session/records/trial_table.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include "common/csv/csv.hpp"
#include "common/error.hpp"

namespace thimble {
namespace {

using Out = std::back_insert_iterator<fmt::memory_buffer>;

// A column knows its name and both directions, so that writer and reader cannot disagree.
struct Column {
    std::string_view name;
    void (*write)(Out, const TrialRow&);
    void (*read)(const CsvField&, TrialRow&);
};

template <auto M>
constexpr Column number(std::string_view name) {
    return {name, [](Out out, const TrialRow& row) { write_number(out, row.*M); },
            [](const CsvField& field, TrialRow& row) { row.*M = field.number(); }};
}

template <auto Part, auto M>
constexpr Column number(std::string_view name) {
    return {name, [](Out out, const TrialRow& row) { write_number(out, (row.*Part).*M); },
            [](const CsvField& field, TrialRow& row) { (row.*Part).*M = field.number(); }};
}

template <auto Part, auto M>
constexpr Column integer(std::string_view name) {
    return {name, [](Out out, const TrialRow& row) { fmt::format_to(out, "{}", (row.*Part).*M); },
            [](const CsvField& field, TrialRow& row) {
                auto& value = (row.*Part).*M;
                using Value = std::remove_reference_t<decltype(value)>;
                value = static_cast<Value>(field.integer(std::numeric_limits<Value>::max()));
            }};
}

template <auto M>
constexpr Column flag(std::string_view name) {
    return {name, [](Out out, const TrialRow& row) { fmt::format_to(out, "{}", row.metrics.*M ? 1 : 0); },
            [](const CsvField& field, TrialRow& row) { row.metrics.*M = field.flag(); }};
}

void write_modality(Out out, const TrialRow& row) {
    fmt::format_to(out, "{}", to_string(row.conditions.modality));
}

void read_modality(const CsvField& field, TrialRow& row) {
    const auto modality = find_modality(field.text);
    if (!modality) field.fail("is none of HF, CF, CCF, VF");
    row.conditions.modality = *modality;
}

void write_removal(Out out, const TrialRow& row) {
    fmt::format_to(out, "{}", row.conditions.removes_fixture ? 1 : 0);
}

void read_removal(const CsvField& field, TrialRow& row) { row.conditions.removes_fixture = field.flag(); }

void write_outcome(Out out, const TrialRow& row) {
    fmt::format_to(out, "{}", outcome_text(row.reason, row.lost_peer));
}

void read_outcome(const CsvField& field, TrialRow& row) {
    if (!parse_outcome(field.text, row.reason, row.lost_peer)) {
        field.fail(
            "is none of completed, timeout, interrupted, emergency_stop, peer_lost_<role>, "
            "device_fault_<role>, safety_stop_<role>");
    }
}

void write_compensator(Out out, const TrialRow& row) {
    fmt::format_to(out, "{}", kCompensatorNames[static_cast<std::size_t>(row.conditions.compensator)]);
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
    integer<&R::conditions, &C::experiment>("experiment"),
    integer<&R::conditions, &C::subject>("subject"),
    integer<&R::conditions, &C::trial>("trial"),
    Column{"modality", write_modality, read_modality},
    number<&R::conditions, &C::delay_s>("delay_s"),
    number<&R::conditions, &C::fixture_position_m>("fixture_position_m"),
    number<&R::metrics, &M::penetration_mean_m>("penetration_mean_m"),
    number<&R::metrics, &M::penetration_max_m>("penetration_max_m"),
    number<&R::metrics, &M::completion_time_s>("completion_time_s"),
    number<&R::metrics, &M::peak_displacement_m>("peak_displacement_m"),
    integer<&R::metrics, &M::contacts_lost>("contacts_lost"),
    number<&R::metrics, &M::oscillation_rms_m>("oscillation_rms_m"),
    number<&R::metrics, &M::oscillation_peak_to_peak_m>("oscillation_peak_to_peak_m"),
    number<&R::metrics, &M::oscillation_frequency_Hz>("oscillation_frequency_Hz"),
    flag<&M::oscillates>("oscillates"),
    flag<&M::beeped>("beeped"),
    Column{"outcome", write_outcome, read_outcome},
    integer<&R::conditions, &C::study_seed>("seed"),
    Column{"fixture_removed", write_removal, read_removal},
    number<&R::delay_achieved_s>("delay_achieved_s"),
    number<&R::round_trip_s>("round_trip_s"),
    number<&R::metrics, &M::puncture_time_s>("puncture_time_s"),
    number<&R::metrics, &M::first_contact_time_s>("first_contact_time_s"),
    number<&R::metrics, &M::duration_s>("duration_s"),
    Column{"remedy", write_compensator, read_compensator},
};

constexpr auto kColumnNames = [] {
    std::array<std::string_view, kColumns.size()> names;
    for (std::size_t i = 0; i < names.size(); ++i) names[i] = kColumns[i].name;
    return names;
}();

std::vector<TrialRow> read_rows(CsvReader reader) {
    std::vector<TrialRow> rows;
    while (reader.next()) {
        TrialRow row;
        for (std::size_t i = 0; i < kColumns.size(); ++i) kColumns[i].read(reader.field(i), row);
        rows.push_back(row);
    }
    return rows;
}

}  // namespace

TrialRow make_row(const TrialRecord& record) {
    return {record.conditions, measure(record),         record.reason,
            record.lost_peer,  record.achieved_delay_s, record.round_trip_s};
}

std::vector<TrialRow> of_experiment(const std::vector<TrialRow>& rows, std::uint32_t experiment) {
    std::vector<TrialRow> kept;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(kept),
                 [&](const TrialRow& row) { return row.conditions.experiment == experiment; });
    return kept;
}

std::vector<TrialRow> without_removals(const std::vector<TrialRow>& rows) {
    std::vector<TrialRow> kept;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(kept),
                 [](const TrialRow& row) { return !row.conditions.removes_fixture; });
    return kept;
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

std::span<const std::string_view> trial_columns() { return kColumnNames; }

void write_trial_field(fmt::memory_buffer& out, const TrialRow& row, std::size_t column) {
    kColumns[column].write(std::back_inserter(out), row);
}

void read_trial_field(const CsvField& field, std::size_t column, TrialRow& row) {
    kColumns[column].read(field, row);
}

TrialTable::TrialTable(const std::filesystem::path& path, IfExists if_exists) : file_(path, if_exists) {
    if (!file_.is_new()) {
        (void)CsvReader(path, kColumnNames);  // of an earlier version: its lines would be shorter
        read_trial_table(path);               // to append to a damaged table would hide the damage
        return;
    }
    file_.write(fmt::format("{}\n", fmt::join(kColumnNames, ",")));
    file_.sync();
}

void TrialTable::append(const TrialRow& row) {
    fmt::memory_buffer line;
    for (const Column& column : kColumns) {
        if (&column != kColumns.data()) line.push_back(',');
        column.write(std::back_inserter(line), row);
    }
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
