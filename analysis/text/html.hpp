// The few pieces of HTML a report is made of. Text is escaped here and nowhere else; the page needs no script
// and nothing from outside.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace thimble {

inline constexpr std::string_view kDash = "–";  // the cell of what does not exist

struct ReportTable {
    std::string title;
    std::string note;  // below the table; may be empty
    std::vector<std::string> columns;
    std::vector<std::vector<std::string>> rows = {};  // each as long as `columns`
};

// Columns that have a dash in every row; a table without rows keeps them.
void drop_empty_columns(ReportTable& table);

std::string html_escape(std::string_view text);
std::string html_element(std::string_view tag, std::string_view text);  // escapes the text
// Cells that are numbers stand to the right.
std::string html_table(const ReportTable& table);
// The same for a terminal: title, columns padded to one width, note.
std::string plain_table(const ReportTable& table);
std::string html_page(std::string_view title, std::string_view body);  // body is HTML

}  // namespace thimble
