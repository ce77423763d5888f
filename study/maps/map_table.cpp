#include "study/maps/map_table.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <system_error>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/text_file.hpp"

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
std::size_t cells_there(const std::filesystem::path& folder, const MapGrid& grid, IfExists if_exists) {
    make_folder(folder);
    const auto table = folder / "map.csv", plan = folder / "map.txt";
    std::size_t cells = 0;
    if (if_exists == IfExists::kRefuse && std::filesystem::exists(table))
        throw Error(
            ExitCode::kUsage,
            "{}: holds a map already: go on with --resume, replace it with --overwrite, or name another "
            "--out",
            folder.string());
    if (if_exists != IfExists::kContinue) {
        CsvFile(table, if_exists);  // empty, or an Error
    } else if (std::filesystem::exists(table)) {
        if (text_of(plan) != grid_text(grid))
            throw Error(ExitCode::kUsage,
                        fmt::format("{}: holds another map: name another folder, or say --overwrite",
                                    folder.string()));
        const std::size_t lines = lines_in(table);
        cells = lines > 0 ? lines - 1 : 0;
        keep_lines(table, cells);
    }
    std::ofstream(plan) << grid_text(grid);
    return cells;
}

}  // namespace

MapTable::MapTable(const std::filesystem::path& folder, const MapGrid& grid, IfExists if_exists)
    : done_(cells_there(folder, grid, if_exists)), file_(folder / "map.csv", IfExists::kContinue) {
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
