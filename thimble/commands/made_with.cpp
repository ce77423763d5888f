// The origin of a report: the program, its session files, the values of all parameters.
#include <string>

#include <fmt/format.h>

#include "common/text_file.hpp"
#include "study/fit/fit.hpp"
#include "thimble/commands/shared.hpp"

namespace thimble {
namespace {

std::string text_of(const std::filesystem::path& file) {
    std::string text = read_text_file(file);
    if (!text.ends_with('\n')) text += '\n';  // of several lines, so that the page folds it
    return text;
}

}  // namespace

Provenance made_with(const std::vector<std::filesystem::path>& session_files, const OtherValues& other) {
    Provenance rows{{"commit", source_commit()}};
    if (!other.fit.empty()) rows.emplace_back("fit " + other.fit.string(), text_of(fit_file(other.fit)));
    for (const std::filesystem::path& file : session_files) {
        const std::string name = file.empty() ? "the defaults" : file.filename().string();
        if (!file.empty()) rows.emplace_back("session file " + name, text_of(file));
        rows.emplace_back("all parameters of " + name, all_parameters(file, other.changes, other.options));
    }
    return rows;
}

}  // namespace thimble
