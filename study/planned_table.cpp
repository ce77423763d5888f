#include "study/planned_table.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>

#include "common/error.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

std::string text_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::size_t lines_in(std::string_view text) {
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

// How many rows are there already; the table is cut back to them.
std::size_t rows_there(const std::filesystem::path& folder, const std::string& name, const std::string& what,
                       const std::string& plan, IfExists if_exists) {
    make_folder(folder);
    const auto table = folder / (name + ".csv"), planned = folder / (name + ".txt");
    std::size_t rows = 0;
    if (if_exists == IfExists::kRefuse && std::filesystem::exists(table))
        throw Error(
            ExitCode::kUsage,
            "{}: holds a {} already: go on with --resume, replace it with --overwrite, or name another "
            "--out",
            folder.string(), what);
    if (if_exists != IfExists::kContinue) {
        CsvFile(table, if_exists);  // empty, or an Error
    } else if (std::filesystem::exists(table)) {
        if (text_of(planned) != plan)
            throw Error(ExitCode::kUsage, "{}: holds another {}: name another folder, or say --overwrite",
                        folder.string(), what);
        const std::size_t lines = lines_in(text_of(table));
        rows = lines > 0 ? lines - 1 : 0;
        keep_lines(table, rows);
    }
    write_text_file(planned, plan);
    return rows;
}

}  // namespace

PlannedTable::PlannedTable(const std::filesystem::path& folder, const std::string& name,
                           const std::string& what, const std::string& plan, std::string_view header,
                           IfExists if_exists)
    : done_(rows_there(folder, name, what, plan, if_exists)),
      file_(folder / (name + ".csv"), IfExists::kContinue) {
    if (file_.is_new()) file_.write(header);
    file_.flush();
}

void PlannedTable::append(std::string_view rows) {
    file_.write(rows);
    done_ += lines_in(rows);
    file_.flush();
}

}  // namespace thimble
