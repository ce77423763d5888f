// Tables as BIDS wants them (Common principles, "Tabular files"): UTF-8, tabs, a header line, "n/a" for what
// is not there.
#pragma once

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <fcntl.h>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <sys/file.h>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/csv/columns.hpp"
#include "common/csv/csv_file.hpp"
#include "common/error.hpp"
#include "common/text_file.hpp"
#include "session/records/participant.hpp"

namespace thimble {

// There, and not empty.
inline bool is_table(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(path, ignored) && std::filesystem::file_size(path, ignored) > 0;
}

inline const std::filesystem::path& with_whole_lines(const std::filesystem::path& path,
                                                     std::span<const std::string_view> columns) {
    if (is_table(path)) CsvReader(path, columns, '\t', 0, LastLine::kMayBeTorn);  // its header, or Error
    keep_lines(path, std::numeric_limits<std::size_t>::max() - 1);
    return path;
}

inline constexpr std::string_view kNotAvailable = "n/a";

// Of a column participant_id. Throws Error (data).
inline std::uint32_t read_participant(const CsvField& field) {
    const auto participant = parse_participant(field.text);
    if (!participant) field.fail("is not a participant, e.g. sub-07");
    return *participant;
}

// Free text as one field: line breaks and tabs become spaces, an empty text becomes "n/a".
inline std::string tsv_text(std::string_view words) {
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

// Of whole lines only.
class TsvFile {
  public:
    // New, or to be continued. Throws Error: data, if it holds other columns; usage, if it cannot be created.
    TsvFile(const std::filesystem::path& path, std::span<const std::string_view> columns)
        : file_(with_whole_lines(path, columns), IfExists::kContinue) {
        if (!file_.is_new()) return;
        file_.write(fmt::format("{}\n", fmt::join(columns, "\t")));
        file_.sync();
    }

    // `line` without its end. On the disk when it returns.
    void append(std::string_view line) {
        file_.write(fmt::format("{}\n", line));
        file_.sync();
    }

  private:
    CsvFile file_;
};

// Replaces a file as a whole: a reader, also after a power cut, finds the old text or the new one.
inline void write_whole(const std::filesystem::path& path, std::string_view text) {
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

// Sessions in one dataset take turns: each reads, changes and replaces a table while it has such a lock on `file`. Without that
// file, or on a file system without locks, none of them waits.
class TurnLock {
  public:
    explicit TurnLock(const std::filesystem::path& file) : file_(::open(file.c_str(), O_RDWR | O_CLOEXEC)) {
        while (file_.get() >= 0 && ::flock(file_.get(), LOCK_EX) != 0 && errno == EINTR) continue;
    }

  private:
    FileDescriptor file_;
};

// A table of participants that is small and replaced as a whole: a reader finds the old one or the new one.
class PersonTable {
  public:
    using Line = std::vector<std::string>;  // the participant first

    // Empty without the file. Throws Error (data).
    PersonTable(std::filesystem::path file, std::vector<std::string> columns)
        : file_(std::move(file)), columns_(std::move(columns)) {
        if (!is_table(file_)) return;
        const std::vector<std::string_view> names(columns_.begin(), columns_.end());
        CsvReader reader(file_, names, '\t');
        while (reader.next()) {
            read_participant(reader.field(0));
            Line& line = lines_.emplace_back();
            for (std::size_t i = 0; i < names.size(); ++i) line.emplace_back(reader.field(i).text);
        }
    }

    const std::filesystem::path& file() const { return file_; }
    // Null if the participant has none.
    Line* find(std::uint32_t participant) {
        const auto found = std::find_if(lines_.begin(), lines_.end(), [&](const Line& line) {
            return parse_participant(line[0]) == participant;
        });
        return found == lines_.end() ? nullptr : &*found;
    }
    // With "n/a" wherever nothing is known.
    Line& line_of(std::uint32_t participant) {
        if (Line* const there = find(participant)) return *there;
        Line line(columns_.size(), std::string(kNotAvailable));
        line[0] = participant_id(participant);
        return lines_.emplace_back(std::move(line));
    }
    void write() const {
        std::string text = fmt::format("{}\n", fmt::join(columns_, "\t"));
        for (const Line& line : lines_) text += fmt::format("{}\n", fmt::join(line, "\t"));
        write_whole(file_, text);
    }

  private:
    std::filesystem::path file_;
    std::vector<std::string> columns_;
    std::vector<Line> lines_;
};

}  // namespace thimble
