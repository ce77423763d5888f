#include "netem/formats/text_lines.hpp"

#include <charconv>
#include <fstream>

#include "common/error.hpp"
#include "common/text_file.hpp"

namespace thimble {

std::string read_whole_file(const std::filesystem::path& path, std::size_t most_bytes) {
    refuse_folder(path, ExitCode::kData);
    std::ifstream stream(path, std::ios::binary);
    if (!stream.is_open()) {
        throw Error(ExitCode::kData, "{}: cannot be read; does this file exist, and is it yours to read?",
                    path.string());
    }
    // Not by the file's size: a pipe has none.
    std::string text = read_to_end(stream, path, most_bytes);
    if (text.size() <= most_bytes) return text;
    throw Error(ExitCode::kData, "{}: is larger than {} bytes, the most that is read", path.string(),
                most_bytes);
}

void fail_at_line(std::string_view name, std::size_t line, std::string_view why) {
    throw Error(ExitCode::kData, "{}:{}: {}", name, line, why);
}

LineReader::LineReader(std::string_view text, std::string_view name) : rest_(text), name_(name) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (rest_.substr(0, kByteOrderMark.size()) == kByteOrderMark) rest_.remove_prefix(kByteOrderMark.size());
    at_end_ = rest_.empty();
}

bool LineReader::next() {
    if (at_end_) return false;
    const std::size_t end = rest_.find('\n');
    line_ = rest_.substr(0, end);
    if (!line_.empty() && line_.back() == '\r') line_.remove_suffix(1);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    at_end_ = rest_.empty();
    ++number_;
    return true;
}

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view kBlanks = " \t";
    const std::size_t first = text.find_first_not_of(kBlanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::vector<std::string_view> words_of(std::string_view text) {
    constexpr std::string_view kBlanks = " \t\r\n";
    std::vector<std::string_view> words;
    for (std::size_t at = text.find_first_not_of(kBlanks); at != std::string_view::npos;) {
        const std::size_t end = text.find_first_of(kBlanks, at);
        words.push_back(text.substr(at, end - at));
        at = text.find_first_not_of(kBlanks, end);
    }
    return words;
}

std::vector<std::string_view> fields_of(std::string_view line) {
    std::vector<std::string_view> fields;
    for (;;) {
        const std::size_t comma = line.find(',');
        fields.push_back(trimmed(line.substr(0, comma)));
        if (comma == std::string_view::npos) return fields;
        line.remove_prefix(comma + 1);
    }
}

std::optional<std::int64_t> parse_integer(std::string_view text) {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) return {};
    return value;
}

}  // namespace thimble
