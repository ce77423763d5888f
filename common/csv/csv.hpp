// The project's own CSV and TSV files, read strictly: a header line of known columns, then lines of plain
// fields (no quoting is needed, no field holds the separator), comment lines from '#'. Errors name line and column. They may have
// gone through a spreadsheet (plain_table), with semicolons only where no line will be added (LastLine::kWhole).
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <boost/core/noncopyable.hpp>
#include <fmt/format.h>

namespace thimble {

// One field and where it stands. The conversions throw Error (data) if the text is not exactly such a value.
struct CsvField {
    const std::filesystem::path* file;
    std::size_t line;    // from 1
    std::size_t column;  // from 1
    std::string_view name;
    std::string_view text;

    double number() const;  // finite; empty is NaN
    std::uint64_t integer(std::uint64_t max) const;
    std::uint32_t whole() const;  // an integer of 32 bits
    bool flag() const;            // 0 or 1
    [[noreturn]] void fail(std::string_view why) const;
};

// A program that is killed while it writes leaves part of a line behind the last newline. kMayBeTorn leaves that part out.
enum class LastLine { kWhole, kMayBeTorn };

class CsvReader : boost::noncopyable {
  public:
    // Throws Error (data) if the file cannot be read or its header is not exactly `columns` (which must
    // outlive the reader). The last `later` columns may be missing, all together: files of earlier versions. Their fields are
    // empty. With kMayBeTorn a file may also be empty or end within its header.
    CsvReader(std::filesystem::path file, std::span<const std::string_view> columns, char separator = ',',
              std::size_t later = 0, LastLine last = LastLine::kWhole);

    // Moves to the next line of fields; false at the end of the file. Throws if the line has the wrong number
    // of fields or does not end in a newline: a number that was cut off still looks like one.
    bool next();
    CsvField field(std::size_t column) const;  // from 0
    // The comment lines passed so far, without "# ".
    const std::vector<std::string>& comments() const { return comments_; }

  private:
    bool ends_within_header() const;
    std::string_view take_line();
    [[noreturn]] void fail(std::string_view why) const;

    std::filesystem::path file_;
    std::span<const std::string_view> columns_;
    char separator_;
    std::size_t there_ = 0;  // columns of this file
    std::string text_;
    std::size_t position_ = 0;
    std::size_t line_ = 0;
    std::vector<std::string_view> fields_;
    std::vector<std::string> comments_;
};

// The shortest text that reads back to the same bits; NaN is an empty field. Any fmt output iterator.
template <class Out>
Out write_number(Out out, double value) {
    return value != value ? out : fmt::format_to(out, "{}", value);
}

// Tables that went through a spreadsheet: a byte order mark, CR LF, semicolons between fields and decimal commas in numbers.
enum class Semicolons { kRefuse, kTake };

// The text as the readers of tables take it, line for line: no byte order mark, LF alone, and `separator` where the header has
// semicolons instead. There, decimal commas become points. Throws Error (data) that names file and line: UTF-16, a comma that is
// no decimal comma, decimal commas beside decimal points, or semicolons that are to be refused.
std::string plain_table(std::string text, std::string_view name, char separator = ',',
                        Semicolons semicolons = Semicolons::kTake);

}  // namespace thimble
