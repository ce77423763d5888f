// Tables as BIDS wants them (Common principles, "Tabular files"): UTF-8, tabs, a header line, "n/a" for what
// is not there.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "common/csv/columns.hpp"
#include "common/csv/csv_file.hpp"

namespace thimble {

inline constexpr std::string_view kNotAvailable = "n/a";

// Of a column participant_id. Throws Error (data).
std::uint32_t read_participant(const CsvField& field);
// Free text as one field: line breaks and tabs become spaces, an empty text becomes "n/a".
std::string tsv_text(std::string_view words);

// Of whole lines only.
class TsvFile {
  public:
    // New, or to be continued. Throws Error: data, if it holds other columns; usage, if it cannot be created.
    TsvFile(const std::filesystem::path& path, std::span<const std::string_view> columns);
    // `line` without its end. On the disk when it returns.
    void append(std::string_view line);

  private:
    CsvFile file_;
};

// There, and not empty.
bool is_table(const std::filesystem::path& path);

// Replaces a file as a whole: a reader, also after a power cut, finds the old text or the new one.
void write_whole(const std::filesystem::path& path, std::string_view text);

}  // namespace thimble
