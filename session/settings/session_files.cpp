#include "session/settings/session_files.hpp"

#include <algorithm>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;

fs::path shipped_folder() { return program_folder().parent_path() / "share" / "thimble" / "sessions"; }

fs::path shipped_file(const std::string& name) { return shipped_folder() / (name + ".toml"); }

std::vector<std::string> shipped_names() {
    std::vector<std::string> names;
    std::error_code absent;
    for (const auto& entry : fs::directory_iterator(shipped_folder(), absent))
        if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
    std::sort(names.begin(), names.end());
    return names;
}

[[noreturn]] void refuse(const std::string& given) {
    const std::vector<std::string> names = shipped_names();
    const std::string known =
        names.empty() ? fmt::format(
                            "{}, where those that come with the program lie, cannot be read: is "
                            "Thimble installed completely?",
                            shipped_folder().string())
                      : fmt::format("those that come with the program are {}", fmt::join(names, ", "));
    throw Error(ExitCode::kUsage, fmt::format("{}: there is no such session file, and {}", given, known));
}

}  // namespace

fs::path program_folder() {
    std::error_code error;
    const auto self = fs::read_symlink("/proc/self/exe", error);
    return error ? fs::path("/usr/bin") : self.parent_path();
}

fs::path find_session_file(const std::string& given) {
    std::error_code absent;
    if (fs::exists(given, absent)) return given;
    const bool plain = !given.empty() && given.find('/') == std::string::npos;
    if (plain && fs::exists(shipped_file(given), absent)) return shipped_file(given);
    refuse(given);
}

std::optional<std::string> shipped_name(const fs::path& file) {
    std::error_code absent;
    const std::string name = file.stem().string();
    if (!fs::equivalent(file, shipped_file(name), absent)) return std::nullopt;
    return name;
}

bool is_paper_session(const fs::path& file) {
    const auto name = shipped_name(file);
    return name && std::find(kPaperSessions.begin(), kPaperSessions.end(), *name) != kPaperSessions.end();
}

}  // namespace thimble
