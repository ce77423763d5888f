#include "analysis/statistics/sample_table.hpp"

#include <cmath>

namespace thimble {
namespace {

constexpr const char* kTable = "table of subjects and conditions";

void require_names(const std::vector<NamedValues>& columns) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
        if (columns[i].name.empty())
            refuse(kTable, "column " + std::to_string(i + 1) + " has no name; give it one");
        for (std::size_t j = 0; j < i; ++j) {
            if (columns[j].name != columns[i].name) continue;
            refuse(kTable, "two columns are named '" + columns[i].name + "'; rename one or merge them");
        }
    }
}

void require_equal_columns(const std::vector<NamedValues>& columns) {
    if (columns.empty()) refuse(kTable, "there is no column; pass one per condition");
    require_names(columns);
    for (const NamedValues& column : columns) {
        if (column.values.size() == columns.front().values.size()) continue;
        refuse(kTable, "column '" + column.name + "' has " + std::to_string(column.values.size()) +
                           " values, '" + columns.front().name + "' has " +
                           std::to_string(columns.front().values.size()) +
                           "; every subject needs one value per condition, NaN where it is missing");
    }
    require_at_least(columns.front(), 1, kTable);
}

bool is_complete(const std::vector<NamedValues>& columns, std::size_t subject) {
    for (const NamedValues& column : columns) {
        if (std::isnan(column.values[subject])) return false;
    }
    return true;
}

}  // namespace

SampleTable SampleTable::from_columns(const std::vector<NamedValues>& columns) {
    require_equal_columns(columns);
    SampleTable table;
    table.subjects_ = columns.front().values.size();
    table.cells_.reserve(table.subjects_ * columns.size());
    for (const NamedValues& column : columns) {
        require_numbers(column, kTable);
        table.names_.push_back(column.name);
    }
    for (std::size_t subject = 0; subject < table.subjects_; ++subject) {
        for (const NamedValues& column : columns) table.cells_.push_back(column.values[subject]);
    }
    return table;
}

NamedValues SampleTable::column(std::size_t condition) const {
    NamedValues column{names_[condition], {}};
    column.values.reserve(subjects_);
    for (std::size_t subject = 0; subject < subjects_; ++subject)
        column.values.push_back(at(subject, condition));
    return column;
}

void SampleTable::require_shape(std::size_t least_subjects, std::size_t least_conditions,
                                std::string_view test) const {
    if (conditions() < least_conditions) {
        refuse(test, std::to_string(conditions()) + " conditions ('" + names_.front() +
                         "' ...), needs at least " + std::to_string(least_conditions) + "; add a condition");
    }
    if (subjects_ < least_subjects) {
        refuse(test, std::to_string(subjects_) + " subjects in columns '" + names_.front() +
                         "' ..., needs at least " + std::to_string(least_subjects) +
                         "; measure more subjects");
    }
}

CompleteRows complete_rows(const std::vector<NamedValues>& columns) {
    require_equal_columns(columns);
    std::vector<NamedValues> kept;
    kept.reserve(columns.size());
    for (const NamedValues& column : columns) kept.push_back({column.name, {}});
    std::vector<std::size_t> dropped;
    for (std::size_t subject = 0; subject < columns.front().values.size(); ++subject) {
        if (!is_complete(columns, subject)) {
            dropped.push_back(subject);
            continue;
        }
        for (std::size_t c = 0; c < columns.size(); ++c) kept[c].values.push_back(columns[c].values[subject]);
    }
    if (kept.front().values.empty()) refuse(kTable, "every subject misses a value; no row is complete");
    return {SampleTable::from_columns(kept), dropped};
}

}  // namespace thimble
