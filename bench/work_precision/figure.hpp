// Cost against position error, one panel per problem.
#pragma once

#include <filesystem>
#include <vector>

#include "bench/work_precision/entry.hpp"

namespace thimble {

// work_precision.svg, with its data and script. Up to four problems. Throws Error if gnuplot is missing.
void draw_work_precision(const std::filesystem::path& directory, const std::vector<Entry>& entries);

}  // namespace thimble
