#include "study/maps/map_table.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <system_error>

#include <fmt/format.h>

#include "common/error.hpp"

namespace thimble {
namespace {

std::string text_of(const std::filesystem::path& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::size_t lines_in(const std::filesystem::path& path) {
    std::ifstream file(path);
    return static_cast<std::size_t>(
        std::count(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>(), '\n'));
}

// How many cells are there already; the table is cut back to them.
std::size_t cells_there(const std::filesystem::path& folder, const MapGrid& grid, bool overwrite) {
    std::error_code failed;  // the table says so
    std::filesystem::create_directories(folder, failed);
    const auto table = folder / "map.csv", plan = folder / "map.txt";
    if (overwrite) std::filesystem::remove(table);
    std::size_t cells = 0;
    if (std::filesystem::exists(table)) {
        if (text_of(plan) != grid_text(grid))
            throw Error(ExitCode::kUsage,
                        fmt::format("{}: another map; give --overwrite or another --out", folder.string()));
        const std::size_t lines = lines_in(table);
        cells = lines > 0 ? lines - 1 : 0;
        keep_lines(table, cells);
    }
    std::ofstream(plan) << grid_text(grid);
    return cells;
}

}  // namespace

MapTable::MapTable(const std::filesystem::path& folder, const MapGrid& grid, bool overwrite)
    : done_(cells_there(folder, grid, overwrite)), file_(folder / "map.csv", IfExists::kContinue) {
    if (file_.is_new()) file_.write(cells_header());
    file_.flush();
}

void MapTable::take(const CellRange& range, std::string rows) {
    waiting_.emplace(range.first, std::pair(range.count, std::move(rows)));
    bool wrote = false;
    for (auto first = waiting_.begin(); first != waiting_.end() && first->first == done_;
         first = waiting_.erase(first)) {
        file_.write(first->second.second);
        done_ += first->second.first;
        wrote = true;
    }
    if (wrote) file_.flush();
}

}  // namespace thimble
