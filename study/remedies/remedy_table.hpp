// The comparison's tables: a line per trial (long form), written as trials come and gone on with, and a line per condition and
// network. SI units, named in the columns.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "common/csv/csv_file.hpp"
#include "study/remedies/remedy_study.hpp"

namespace thimble {

class RemedyTrialTable {
  public:
    // With kContinue the first trials of the plan get what the table says of them. Throws Error: usage, if the file exists and may
    // not be replaced, or is of another plan; data, if it is damaged.
    RemedyTrialTable(const std::filesystem::path& path, IfExists if_exists,
                     const std::vector<RemedyCondition>& conditions, std::vector<RemedyTrial>& plan);
    std::size_t done() const { return done_; }  // trials of the plan that were there
    void append(const RemedyTrial& trial);      // it is on the disk then

  private:
    std::vector<std::string> names_;
    std::size_t done_;
    CsvFile file_;
};

// remedies.csv
std::string remedy_rows_csv(const std::vector<RemedyRow>& rows);
// An array of objects with the columns' names; what does not exist is null.
nlohmann::ordered_json remedy_rows_json(const std::vector<RemedyRow>& rows);

}  // namespace thimble
