// subjects.csv: what was drawn for each virtual subject. SI units, named in the columns.
#pragma once

#include <filesystem>
#include <vector>

#include "experiment/csv_file.hpp"
#include "experiment/protocol.hpp"
#include "master/operator/operator_parameters.hpp"

namespace thimble {

// A line per subject of each cohort (experiments 1 and 2 have the same people). Throws Error as CsvFile.
void write_subjects(const std::filesystem::path& path, IfExists if_exists,
                    const OperatorParameters& parameters, const std::vector<Protocol>& protocols);

}  // namespace thimble
