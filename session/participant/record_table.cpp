#include "session/participant/record_table.hpp"

#include <array>

#include "common/text_file.hpp"

namespace thimble {
namespace {

constexpr std::array<std::string_view, 7> kOwnColumns{
    "record", "position", "block", "practice", "repeat_of", "repeat_reason", "number_on_wire"};

std::filesystem::path in_its_folder(const std::filesystem::path& file) {
    make_folder(file.parent_path());
    return file;
}

DatasetRecord read_record(const CsvReader& line) {
    DatasetRecord r;
    r.record = line.field(0).whole();
    r.position = line.field(1).whole();
    r.block = line.field(2).whole();
    r.practice = line.field(3).flag();
    if (line.field(4).text != kNotAvailable) r.repeat_of = line.field(4).whole();
    r.repeat_reason = without_na(line.field(5)).text;
    r.number = line.field(6).whole();
    for (std::size_t i = 0; i < trial_columns().size(); ++i) {
        read_trial_field(without_na(line.field(kOwnColumns.size() + i)), i, r.row);
    }
    return r;
}

}  // namespace

std::vector<std::string_view> record_columns() {
    std::vector<std::string_view> columns(kOwnColumns.begin(), kOwnColumns.end());
    columns.insert(columns.end(), trial_columns().begin(), trial_columns().end());
    return columns;
}

RecordTable::RecordTable(const std::filesystem::path& file) : file_(in_its_folder(file), record_columns()) {}

void RecordTable::append(const DatasetRecord& r) {
    std::vector<std::string> fields{
        std::to_string(r.record),
        std::to_string(r.position),
        std::to_string(r.block),
        r.practice ? "1" : "0",
        r.repeat_of == 0 ? std::string(kNotAvailable) : std::to_string(r.repeat_of),
        tsv_text(r.repeat_reason),
        std::to_string(r.number)};
    for (std::size_t i = 0; i < trial_columns().size(); ++i) {
        fmt::memory_buffer field;
        write_trial_field(field, r.row, i);
        fields.push_back(field.size() == 0 ? std::string(kNotAvailable) : fmt::to_string(field));
    }
    file_.append(fields);
}

std::vector<DatasetRecord> read_records(const std::filesystem::path& file) {
    std::vector<DatasetRecord> records;
    if (!is_table(file)) return records;
    const auto columns = record_columns();
    CsvReader reader(file, columns, '\t', kLaterColumns);
    while (reader.next()) {
        records.push_back(read_record(reader));
        if (records.back().record != records.size()) reader.field(0).fail("is not the next record");
    }
    return records;
}

}  // namespace thimble
