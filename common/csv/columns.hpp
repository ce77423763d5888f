// A table's columns, each named once: how a row's value is written to it and read back.
#pragma once

#include <array>
#include <concepts>
#include <iterator>
#include <limits>
#include <string>
#include <string_view>

#include "common/csv/csv.hpp"
#include "common/messages.hpp"

namespace thimble {

// One field, without a separator; nothing for a value that is not there. read_value() throws as CsvField does.
inline void write_value(fmt::memory_buffer& out, double value) {
    write_number(std::back_inserter(out), value);
}
inline void read_value(const CsvField& field, double& value) { value = field.number(); }

template <std::same_as<bool> Flag>  // nothing that only converts to bool
void write_value(fmt::memory_buffer& out, Flag value) {
    out.push_back(value ? '1' : '0');
}
inline void read_value(const CsvField& field, bool& value) { value = field.flag(); }

template <std::unsigned_integral Value>
requires(!std::same_as<Value, bool>) void write_value(fmt::memory_buffer& out, Value value) {
    fmt::format_to(std::back_inserter(out), "{}", value);
}
template <std::unsigned_integral Value>
void read_value(const CsvField& field, Value& value) {
    value = static_cast<Value>(field.integer(std::numeric_limits<Value>::max()));
}

inline void write_value(fmt::memory_buffer& out, std::string_view value) { out.append(value); }
inline void read_value(const CsvField& field, std::string& value) { value = field.text; }

inline void write_value(fmt::memory_buffer& out, Modality value) { write_value(out, to_string(value)); }
inline void read_value(const CsvField& field, Modality& value) {
    const auto modality = find_modality(field.text);
    if (!modality) field.fail("is none of HF, CF, CCF, VF");
    value = *modality;
}

template <class Row>
struct TableColumn {
    std::string_view name;
    void (*write)(fmt::memory_buffer&, const Row&);
    void (*read)(const CsvField&, Row&);
};

// The value at row.*Path, or at (row.*First).*Second.
template <class Row, auto... Path>
constexpr TableColumn<Row> column(std::string_view name) {
    return {name, [](fmt::memory_buffer& out, const Row& row) { write_value(out, (row.*....*Path)); },
            [](const CsvField& field, Row& row) { read_value(field, (row.*....*Path)); }};
}

template <class Row, std::size_t N>
constexpr std::array<std::string_view, N> names_of(const std::array<TableColumn<Row>, N>& columns) {
    std::array<std::string_view, N> names;
    for (std::size_t i = 0; i < N; ++i) names[i] = columns[i].name;
    return names;
}

// A row's fields with separators between them; `absent` stands for each value that is not there.
template <class Columns, class Row>
void write_fields(fmt::memory_buffer& out, const Columns& columns, const Row& row, char separator = ',',
                  std::string_view absent = {}) {
    for (const auto& column : columns) {
        if (&column != &*columns.begin()) out.push_back(separator);
        const std::size_t before = out.size();
        column.write(out, row);
        if (out.size() == before) out.append(absent);
    }
}

// From the fields of a line that begin at `first`.
template <class Columns, class Row>
void read_fields(const CsvReader& line, const Columns& columns, Row& row, std::size_t first = 0,
                 std::string_view absent = {}) {
    for (const auto& column : columns) {
        CsvField field = line.field(first++);
        if (field.text == absent) field.text = {};
        column.read(field, row);
    }
}

}  // namespace thimble
