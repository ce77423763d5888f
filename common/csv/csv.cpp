#include "common/csv/csv.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/ranges.h>

#include "common/decimal_text.hpp"
#include "common/error.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

constexpr std::size_t kMostBytes = std::numeric_limits<std::size_t>::max() - 1;

}  // namespace

double CsvField::number() const {
    if (text.empty()) return std::numeric_limits<double>::quiet_NaN();
    const auto value = parse_number(text);
    if (!value) fail("is not a finite number");
    return *value;
}

std::uint64_t CsvField::integer(std::uint64_t max) const {
    const auto value = parse_whole<std::uint64_t>(text);
    if (!value || *value > max) fail(fmt::format("is not a whole number from 0 to {}", max));
    return *value;
}

std::uint32_t CsvField::whole() const {
    return static_cast<std::uint32_t>(integer(std::numeric_limits<std::uint32_t>::max()));
}

bool CsvField::flag() const {
    if (text != "0" && text != "1") fail("is neither 0 nor 1");
    return text == "1";
}

void CsvField::fail(std::string_view why) const {
    throw Error(ExitCode::kData, "{}:{}: column {} ({}): '{}' {}; restore the file or delete this line",
                file->string(), line, column, name, text, why);
}

CsvReader::CsvReader(std::filesystem::path file, std::span<const std::string_view> columns, char separator,
                     std::size_t later, LastLine last)
    : file_(std::move(file)),
      columns_(columns),
      separator_(separator),
      text_(plain_table(read_whole_file(file_, kMostBytes), file_.string(), separator,
                        last == LastLine::kWhole ? Semicolons::kTake : Semicolons::kRefuse)) {
    if (last == LastLine::kMayBeTorn) {
        if (ends_within_header()) {
            text_.clear();
            return;
        }
        if (const std::size_t end = text_.rfind('\n'); end != std::string::npos) text_.resize(end + 1);
    }
    split_at(separator_, take_line(), fields_);
    there_ = fields_.size();
    if (there_ != columns_.size() && there_ + later != columns_.size()) {
        fail(fmt::format(
            "has {} columns instead of {}; it was written by another version or is another kind of file",
            fields_.size(), columns_.size()));
    }
    for (std::size_t i = 0; i < there_; ++i) {
        if (fields_[i] != columns_[i]) field(i).fail("is not the name of this column");
    }
}

bool CsvReader::ends_within_header() const {
    return fmt::format("{}", fmt::join(columns_, std::string_view(&separator_, 1))).starts_with(text_);
}

bool CsvReader::next() {
    while (position_ < text_.size()) {
        const std::string_view line = take_line();
        if (line.starts_with('#')) {
            comments_.emplace_back(line.substr(line.starts_with("# ") ? 2 : 1));
            continue;
        }
        split_at(separator_, line, fields_);
        if (fields_.size() != there_) {
            fail(fmt::format("has {} fields instead of {} (column '{}' is the last one); delete this line",
                             fields_.size(), there_, columns_[std::min(fields_.size(), there_) - 1]));
        }
        return true;
    }
    return false;
}

CsvField CsvReader::field(std::size_t column) const {
    return {&file_, line_, column + 1, columns_[column],
            column < there_ ? fields_[column] : std::string_view{}};
}

std::string_view CsvReader::take_line() {
    ++line_;
    const std::size_t end = text_.find('\n', position_);
    if (end == std::string::npos) fail("is cut off: the line does not end; delete it");
    const std::string_view line = std::string_view{text_}.substr(position_, end - position_);
    position_ = end + 1;
    return line;
}

void CsvReader::fail(std::string_view why) const {
    throw Error(ExitCode::kData, "{}:{}: {}", file_.string(), line_, why);
}

}  // namespace thimble
