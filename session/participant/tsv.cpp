#include "session/participant/tsv.hpp"

#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"
#include "session/records/participant.hpp"

namespace thimble {
namespace {

constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max() - 1;

const std::filesystem::path& with_whole_lines(const std::filesystem::path& path,
                                              std::span<const std::string_view> columns) {
    if (is_table(path)) CsvReader(path, columns, '\t', 0, LastLine::kMayBeTorn);  // its header, or Error
    keep_lines(path, kAll);
    return path;
}

}  // namespace

std::uint32_t read_participant(const CsvField& field) {
    const auto participant = parse_participant(field.text);
    if (!participant) field.fail("is no participant, e.g. sub-07");
    return *participant;
}

std::string tsv_text(std::string_view words) {
    std::string text;
    for (const char c : words) {
        const bool breaks = static_cast<unsigned char>(c) < ' ' || c == '\x7f';
        if (breaks || c == ' ') {
            if (!text.empty() && text.back() != ' ') text += ' ';
        } else {
            text += c;
        }
    }
    while (!text.empty() && text.back() == ' ') text.pop_back();
    return text.empty() ? std::string(kNotAvailable) : text;
}

TsvFile::TsvFile(const std::filesystem::path& path, std::span<const std::string_view> columns)
    : file_(with_whole_lines(path, columns), IfExists::kContinue) {
    if (!file_.is_new()) return;
    file_.write(fmt::format("{}\n", fmt::join(columns, "\t")));
    file_.sync();
}

void TsvFile::append(std::string_view line) {
    file_.write(fmt::format("{}\n", line));
    file_.sync();
}

bool is_table(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(path, ignored) && std::filesystem::file_size(path, ignored) > 0;
}

void write_whole(const std::filesystem::path& path, std::string_view text) {
    const std::filesystem::path next = path.string() + ".new";
    {
        CsvFile file(next, IfExists::kReplace);
        file.write(text);
        file.sync();
    }
    std::error_code failure;
    std::filesystem::rename(next, path, failure);
    if (failure) {
        throw Error(ExitCode::kRunFailed, "{}: cannot be put in place: {}", path.string(), failure.message());
    }
}

}  // namespace thimble
