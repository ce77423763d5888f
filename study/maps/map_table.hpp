// map.csv while it grows: rows stand in the order of the cells, so that its bytes depend on nothing but the map, and what a
// killed program leaves can be gone on with.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "common/csv/csv_file.hpp"
#include "study/maps/cells.hpp"

namespace thimble {

class MapTable {
  public:
    // In `folder`, made if missing: kContinue goes on behind the whole rows that are there, if they are of the same map.
    // Throws Error (usage, run failed).
    MapTable(const std::filesystem::path& folder, const MapGrid& grid, IfExists if_exists);

    std::size_t done() const { return done_; }  // cells, from the first on
    // In any order; a block is written as soon as all before it are.
    void take(const CellRange& range, std::string rows);

  private:
    std::size_t done_;
    CsvFile file_;
    std::map<std::size_t, std::pair<std::size_t, std::string>> waiting_;  // count and rows, by first cell
};

}  // namespace thimble
