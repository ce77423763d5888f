// subjects.csv: what was drawn for each virtual subject. SI units, named in the columns.
#pragma once

#include <filesystem>
#include <vector>

#include "master/operator/operator_parameters.hpp"
#include "session/settings/protocol.hpp"

namespace thimble {

// A line per subject of each cohort (experiments 1 and 2 have the same people). Replaces the file; throws Error
// as CsvFile.
void write_subjects(const std::filesystem::path& path, const OperatorParameters& parameters,
                    const std::vector<Protocol>& protocols);

}  // namespace thimble
