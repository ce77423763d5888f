// Subjects x conditions: what every test on one group of subjects starts from. Row s holds the values of
// subject s in all conditions, column c the values of all subjects in condition c.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "analysis/statistics/named_values.hpp"

namespace thimble {

class SampleTable {
  public:
    // Value s of each column is subject s. Throws Error (kData) for no column, no subject, columns of unequal
    // length, an empty or repeated name, a value that is missing (NaN), infinite or beyond kLargestValue.
    static SampleTable from_columns(const std::vector<NamedValues>& columns);

    std::size_t subjects() const { return subjects_; }
    std::size_t conditions() const { return names_.size(); }
    double at(std::size_t subject, std::size_t condition) const {
        return cells_[subject * conditions() + condition];
    }
    std::span<const double> row(std::size_t subject) const {
        return std::span(cells_).subspan(subject * conditions(), conditions());
    }
    NamedValues column(std::size_t condition) const;
    const std::string& name(std::size_t condition) const { return names_[condition]; }
    std::span<const double> cells() const { return cells_; }  // row-major

    // Throws Error (kData) unless there are at least that many.
    void require_shape(std::size_t least_subjects, std::size_t least_conditions, std::string_view test) const;

  private:
    SampleTable() = default;

    std::vector<std::string> names_;
    std::vector<double> cells_;
    std::size_t subjects_ = 0;
};

// Listwise deletion: a subject with a missing cell (NaN) is left out of all conditions. Biased unless cells are
// missing by chance, so say how many were dropped. Infinite cells are an error, not missing. A table without a
// complete row is an error too.
struct CompleteRows {
    SampleTable table;
    std::vector<std::size_t> dropped;  // subjects left out, as numbered in the columns, from 0
};
CompleteRows complete_rows(const std::vector<NamedValues>& columns);

}  // namespace thimble
