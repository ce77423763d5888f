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

// Replaces the value of `key`, or appends the line if there is none, as for a key without a default.
void replace_value(std::string& parameters, const std::string& key, const std::string& value) {
    const std::string start = key + " = ";
    std::size_t at = parameters.starts_with(start) ? 0 : parameters.find('\n' + start);
    if (at == std::string::npos) {
        parameters += start + value + '\n';
        return;
    }
    at = parameters.find(start, at) + start.size();
    parameters.replace(at, parameters.find('\n', at) - at, value);
}

std::string parameters_of(const std::filesystem::path& file, const OtherValues& other) {
    std::string text = all_parameters(file, other.changes);
    for (const auto& [key, value] : other.options) replace_value(text, key, value);
    return text;
}

}  // namespace

Provenance made_with(const std::vector<std::filesystem::path>& session_files, const OtherValues& other) {
    Provenance rows{{"commit", source_commit()}};
    if (!other.fit.empty()) rows.emplace_back("fit " + other.fit.string(), text_of(fit_file(other.fit)));
    for (const std::filesystem::path& file : session_files) {
        const std::string name = file.empty() ? "the defaults" : file.filename().string();
        if (!file.empty()) rows.emplace_back("session file " + name, text_of(file));
        rows.emplace_back("all parameters of " + name, parameters_of(file, other));
    }
    return rows;
}

}  // namespace thimble
