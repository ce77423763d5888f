#include "session/participant/record_table.hpp"

#include <array>

#include "common/error.hpp"
#include "common/text_file.hpp"
#include "session/participant/tsv.hpp"
#include "session/records/participant.hpp"

namespace thimble {
namespace {

using R = DatasetRecord;

constexpr std::array kOwnColumns{
    column<R, &R::record>("record"),
    column<R, &R::position>("position"),
    column<R, &R::block>("block"),
    column<R, &R::practice>("practice"),
    TableColumn<R>{"repeat_of",
                   [](fmt::memory_buffer& out, const R& r) {
                       if (r.repeat_of != 0) write_value(out, r.repeat_of);
                   },
                   [](const CsvField& field, R& r) {
                       if (!field.text.empty()) read_value(field, r.repeat_of);
                   }},
    TableColumn<R>{"repeat_reason",
                   [](fmt::memory_buffer& out, const R& r) { write_value(out, tsv_text(r.repeat_reason)); },
                   [](const CsvField& field, R& r) { r.repeat_reason = field.text; }},
    column<R, &R::number>("number_on_wire")};

std::filesystem::path in_its_folder(const std::filesystem::path& file) {
    make_folder(file.parent_path());
    return file;
}

}  // namespace

std::vector<std::string_view> record_columns() {
    std::vector<std::string_view> names;
    names.reserve(kOwnColumns.size() + trial_columns().size());
    for (const auto& column : kOwnColumns) names.push_back(column.name);
    for (const auto& column : trial_columns()) names.push_back(column.name);
    return names;
}

RecordTable::RecordTable(const std::filesystem::path& file) : file_(in_its_folder(file), record_columns()) {}

void RecordTable::append(const DatasetRecord& r) {
    fmt::memory_buffer line;
    write_fields(line, kOwnColumns, r, '\t', kNotAvailable);
    line.push_back('\t');
    write_fields(line, trial_columns(), r.row, '\t', kNotAvailable);
    file_.append({line.data(), line.size()});
}

std::vector<DatasetRecord> read_records(const std::filesystem::path& file) {
    std::vector<DatasetRecord> records;
    if (!is_table(file)) return records;
    const auto columns = record_columns();
    CsvReader reader(file, columns, '\t', kLaterColumns);
    while (reader.next()) {
        DatasetRecord& record = records.emplace_back();
        read_fields(reader, kOwnColumns, record, 0, kNotAvailable);
        read_fields(reader, trial_columns(), record.row, kOwnColumns.size(), kNotAvailable);
        if (records.back().record != records.size()) reader.field(0).fail("is not the next record");
    }
    return records;
}

namespace {

using A = AttentionResult;

constexpr std::array kAttentionColumns{
    TableColumn<A>{
        "participant_id",
        [](fmt::memory_buffer& out, const A& a) { write_value(out, participant_id(a.participant)); },
        [](const CsvField& field, A& a) { a.participant = read_participant(field); }},
    column<A, &A::position>("position"),
    column<A, &A::record>("record"),
    column<A, &A::beep_time_s>("beep_time_s"),
    column<A, &A::limit_s>("limit_s"),
    column<A, &A::passed>("passed")};
constexpr auto kAttentionNames = names_of(kAttentionColumns);

using E = Exclusion;

constexpr std::array kExclusionColumns{
    TableColumn<E>{
        "participant_id",
        [](fmt::memory_buffer& out, const E& e) { write_value(out, participant_id(e.participant)); },
        [](const CsvField& field, E& e) { e.participant = read_participant(field); }},
    column<E, &E::position>("position"), column<E, &E::record>("record"),
    TableColumn<E>{"kind", [](fmt::memory_buffer& out, const E& e) { write_value(out, to_string(e.kind)); },
                   [](const CsvField& field, E& e) {
                       for (const auto kind :
                            {ExclusionKind::kExcluded, ExclusionKind::kRejected, ExclusionKind::kIncluded}) {
                           if (field.text != to_string(kind)) continue;
                           e.kind = kind;
                           return;
                       }
                       field.fail("is not excluded, rejected or included");
                   }},
    column<E, &E::reason>("reason")};
constexpr auto kExclusionNames = names_of(kExclusionColumns);

}  // namespace

AttentionResult judge_attention(std::uint32_t participant, const DatasetRecord& record, Duration limit) {
    const TrialMetrics& m = record.row.metrics;
    AttentionResult result{participant, record.position, record.record};
    result.beep_time_s = m.beeped ? m.puncture_time_s + m.completion_time_s : TrialMetrics::kNone;
    result.limit_s = to_seconds(limit);
    result.passed = result.beep_time_s <= result.limit_s;
    return result;
}

void add_attention(const std::filesystem::path& file, const AttentionResult& result) {
    fmt::memory_buffer line;
    write_fields(line, kAttentionColumns, result, '\t', kNotAvailable);
    TsvFile(file, kAttentionNames).append({line.data(), line.size()});
}

std::vector<AttentionResult> read_attention(const std::filesystem::path& file, LastLine last) {
    std::vector<AttentionResult> all;
    if (!is_table(file)) return all;
    CsvReader reader(file, kAttentionNames, '\t', 0, last);
    while (reader.next()) {
        AttentionResult result;
        read_fields(reader, kAttentionColumns, result, 0, kNotAvailable);
        std::erase_if(all, [&](const AttentionResult& earlier) {
            return earlier.participant == result.participant && earlier.position == result.position;
        });
        all.push_back(result);
    }
    return all;
}

const char* to_string(ExclusionKind kind) {
    static constexpr std::array kNames{"excluded", "rejected", "included"};
    return kNames.at(static_cast<std::size_t>(kind));
}

void add_exclusion(const std::filesystem::path& file, Exclusion e) {
    e.reason = tsv_text(e.reason);
    if (e.reason == kNotAvailable) {
        throw Error(ExitCode::kUsage, "a trial is excluded with a reason only: give one");
    }
    fmt::memory_buffer line;
    write_fields(line, kExclusionColumns, e, '\t');
    TsvFile(file, kExclusionNames).append({line.data(), line.size()});
}

std::vector<Exclusion> read_exclusions(const std::filesystem::path& file, LastLine last) {
    std::vector<Exclusion> all;
    if (!is_table(file)) return all;
    CsvReader reader(file, kExclusionNames, '\t', 0, last);
    while (reader.next()) read_fields(reader, kExclusionColumns, all.emplace_back());
    return all;
}

const Exclusion* find_exclusion(const std::vector<Exclusion>& all, std::uint32_t participant,
                                std::uint32_t record) {
    const Exclusion* found = nullptr;
    for (const Exclusion& e : all) {
        if (e.participant != participant || e.record != record) continue;
        if (e.kind == ExclusionKind::kIncluded)
            found = nullptr;
        else if (found == nullptr || e.kind == ExclusionKind::kExcluded)
            found = &e;
    }
    return found;
}

}  // namespace thimble
