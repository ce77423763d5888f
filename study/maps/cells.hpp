// The cells of a map, measured: rows of its table.
#pragma once

#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "study/maps/map_grid.hpp"

namespace thimble {

struct CellRange {
    std::size_t first = 0, count = 0;
};

// CSV with units, long form; what a cell does not have is empty.
std::string cells_header();
// Works out cells, in several threads at a time if need be. The same bytes for a cell wherever and in whatever company.
class CellWriter {
  public:
    explicit CellWriter(const MapGrid& grid);  // which must outlive it
    std::string rows(const CellRange& range);

  private:
    // Expensive, and shared by all cells of a hand and delay.
    double critical_N_per_m(const CellPlace& place);

    const MapGrid& grid_;
    std::mutex mutex_;
    std::vector<std::optional<double>> critical_N_per_m_;  // by hand and delay
};

// The theory of a column (all of its cells have the same): the stiffness at which the loop without compensator, jitter and loss becomes
// unstable, of the passive hand or of the virtual operator's nominal one.
double passive_critical_N_per_m(const MapGrid& grid, const CellPlace& place);
double virtual_critical_N_per_m(const MapGrid& grid, const CellPlace& place);
// The fields of a row from growth_per_s on.
std::string passive_measures(const MapGrid& grid, const CellPlace& place, double critical_N_per_m);
std::string virtual_measures(const MapGrid& grid, const CellPlace& place);

}  // namespace thimble
