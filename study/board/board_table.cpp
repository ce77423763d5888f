// board.csv: its lines, written and read.
#include <iterator>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/csv/csv.hpp"
#include "common/csv/csv_file.hpp"
#include "study/board/board_row.hpp"

namespace thimble {
namespace {

constexpr std::array kBefore{"controller", "codec", "condition", "delay_s", "jitter_spread_s", "loss",
                             "network",    "hands", "tissue",    "scene",   "trials"};
constexpr std::array kBehind{"failing_subject", "status"};

std::vector<std::string> columns() {
    std::vector<std::string> names(kBefore.begin(), kBefore.end());
    names.reserve(kBefore.size() + 3 * kBoardMeasures + kBehind.size());
    for (const std::string_view measure : kBoardMeasureColumns) {
        names.emplace_back(measure);
        names.push_back(fmt::format("{}_low", measure));
        names.push_back(fmt::format("{}_high", measure));
    }
    names.insert(names.end(), kBehind.begin(), kBehind.end());
    return names;
}

BoardRow row_in(const CsvReader& line) {
    std::size_t at = 0;
    const auto text = [&] { return std::string(line.field(at++).text); };
    const auto number = [&] { return line.field(at++).number(); };
    BoardRow row;
    for (std::string* const field : {&row.controller, &row.codec, &row.condition}) *field = text();
    for (double* const field : {&row.delay_s, &row.jitter_s, &row.loss}) *field = number();
    for (std::string* const field : {&row.network, &row.hands, &row.tissue, &row.scene}) *field = text();
    row.trials = line.field(at++).whole();
    for (BoardValue& value : row.values)
        for (double* const field : {&value.mean, &value.low, &value.high}) *field = number();
    row.subject = line.field(at++).whole();
    row.status = text();
    return row;
}

}  // namespace

std::string board_header() { return fmt::format("{}\n", fmt::join(columns(), ",")); }

std::string board_line(const BoardRow& row) {
    std::string line =
        fmt::format("{},{},{},{},{},{},{},{},{},{},{}", row.controller, row.codec, row.condition, row.delay_s,
                    row.jitter_s, row.loss, row.network, row.hands, row.tissue, row.scene, row.trials);
    for (const BoardValue& value : row.values) {
        for (const double number : {value.mean, value.low, value.high}) {
            line += ',';
            write_number(std::back_inserter(line), number);
        }
    }
    return line + fmt::format(",{},{}\n", row.subject, row.status);
}

std::vector<BoardRow> read_board_rows(const std::filesystem::path& file) {
    const std::vector<std::string> names = columns();
    const std::vector<std::string_view> views(names.begin(), names.end());
    CsvReader reader(file, views);
    std::vector<BoardRow> rows;
    while (reader.next()) rows.push_back(row_in(reader));
    return rows;
}

}  // namespace thimble
