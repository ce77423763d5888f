#include "study/planned_table.hpp"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

std::size_t lines_in(std::string_view text) {
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

// Number of rows that are kept; the table is cut back to them.
std::size_t rows_there(const std::filesystem::path& folder, const std::string& name, const std::string& what,
                       const std::string& plan, IfExists if_exists, const std::vector<std::string>& results) {
    const auto table = folder / (name + ".csv");
    open_plan(table, folder / (name + ".txt"), what, plan, if_exists, results);
    const std::size_t lines = lines_in(read_text_file(table));
    const std::size_t rows = lines > 0 ? lines - 1 : 0;
    keep_lines(table, rows);
    return rows;
}

// A scene's name may also start from the working directory.
std::string used_files_text(const std::filesystem::path& session) {
    if (session.empty()) return "";
    const ConfigFile file = ConfigFile::load(session);
    read_system_settings(file);  // which reads, and so names, every file
    std::string text;
    for (const std::string& name : file.used_files()) {
        const auto beside = file.folder() / name;
        text += fmt::format(
            "{} sha256 {}\n", name,
            sha256_of_file(std::filesystem::exists(beside) ? beside : std::filesystem::path(name)));
    }
    return text;
}

}  // namespace

void require_plan(const std::filesystem::path& plan_file, const std::string& what, const std::string& plan) {
    std::error_code unknown;
    if (!std::filesystem::exists(plan_file, unknown))
        throw Error(ExitCode::kUsage,
                    "{}: is missing, and without it nothing says which settings the {} had: replace it with "
                    "--overwrite, or name another folder with --out",
                    plan_file.string(), what);
    if (read_text_file(plan_file) == plan) return;
    throw Error(ExitCode::kUsage,
                "{}: holds a {} with other settings: repeat these settings, replace it with --overwrite, or "
                "name another folder with --out",
                plan_file.parent_path().string(), what);
}

void open_plan(const std::filesystem::path& table, const std::filesystem::path& plan_file,
               const std::string& what, const std::string& plan, IfExists if_exists,
               const std::vector<std::string>& results) {
    const std::filesystem::path folder = table.parent_path();
    make_folder(folder);
    const bool begun = std::filesystem::exists(table);
    if (begun && if_exists == IfExists::kRefuse)
        throw Error(ExitCode::kUsage,
                    "{}: holds a {} already: continue it with --resume, replace it with --overwrite, or name "
                    "another folder with --out",
                    folder.string(), what);
    if (begun) CsvFile(table, IfExists::kContinue);  // an Error if another program writes it
    if (begun && if_exists == IfExists::kContinue) return require_plan(plan_file, what, plan);
    remove_file(table);  // a program that is killed leaves no table beside the plan of another
    for (const std::string& name : results) remove_file(folder / name);
    write_text_file(plan_file, plan);
    CsvFile(table, if_exists);  // empty, or an Error
}

std::string session_text(const SystemSettings& settings) {
    return used_files_text(settings.file) + "session file:\n" + read_text_file(settings.file);
}

PlannedTable::PlannedTable(const std::filesystem::path& folder, const std::string& name,
                           const std::string& what, const std::string& plan, std::string_view header,
                           IfExists if_exists, const std::vector<std::string>& results)
    : done_(rows_there(folder, name, what, plan, if_exists, results)),
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
