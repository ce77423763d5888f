// The origin of a report: the program, its session files, the values of all parameters.
#include <fstream>
#include <iterator>
#include <string>

#include <fmt/format.h>

#include "thimble/commands/shared.hpp"

namespace thimble {
namespace {

std::string text_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    if (!text.ends_with('\n')) text += '\n';  // of several lines, so that the page folds it
    return text;
}

}  // namespace

Provenance made_with(const std::vector<std::filesystem::path>& session_files) {
    Provenance rows{{"commit", source_commit()}};
    for (const std::filesystem::path& file : session_files) {
        const std::string name = file.empty() ? "the defaults" : file.filename().string();
        if (!file.empty()) rows.emplace_back("session file " + name, text_of(file));
        rows.emplace_back("all parameters of " + name, all_parameters(file));
    }
    return rows;
}

}  // namespace thimble
