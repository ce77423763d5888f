// The comparison's tables: a line per trial (long form), written as trials come and gone on with, and a line per condition and
// network. SI units, named in the columns.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "common/csv/csv_file.hpp"
#include "study/compensators/compensator_study.hpp"

namespace thimble {

class CompensatorTrialTable {
  public:
    // The first trials of the plan get what the table says of them, if it is there. Throws Error: usage, if it is of another plan;
    // data, if it is damaged.
    CompensatorTrialTable(const std::filesystem::path& path,
                          const std::vector<CompensatorCondition>& conditions,
                          std::vector<CompensatorTrial>& plan);
    std::size_t done() const { return done_; }   // trials of the plan that were there
    void append(const CompensatorTrial& trial);  // it is on the disk then

  private:
    std::vector<std::string> names_;
    std::size_t done_;
    CsvFile file_;
};

// compensators.csv
std::string compensator_rows_csv(const std::vector<CompensatorRow>& rows);
// An array of objects with the columns' names; what does not exist is null.
nlohmann::ordered_json compensator_rows_json(const std::vector<CompensatorRow>& rows);

}  // namespace thimble
