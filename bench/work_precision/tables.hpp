// The tables that the study writes and prints.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/work_precision/entry.hpp"
#include "bench/work_precision/real_time.hpp"

namespace thimble {

// The error at which solvers are compared.
inline constexpr double kEqualError_m = 1e-9;

// work_precision.csv and real_time.csv; existing files are replaced. Throws Error.
void write_entries(const std::filesystem::path& file, const std::vector<Entry>& entries);
void write_real_time(const std::filesystem::path& file, const std::vector<RealTimeRow>& rows);

// Per problem: each solver's cheapest setting that reaches kEqualError_m, and its cost against `exact`.
std::string comparison_table(const std::vector<Entry>& entries);
// `exact` on every problem: its errors and its cost.
std::string exact_table(const std::vector<Entry>& entries);
std::string real_time_table(const std::vector<RealTimeRow>& rows);

// The problems of the entries, in their order.
std::vector<const Problem*> problems_of(const std::vector<Entry>& entries);

}  // namespace thimble
