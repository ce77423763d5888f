#include "analysis/text/html.hpp"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <utility>

#include <boost/algorithm/string/replace.hpp>
#include <fmt/format.h>

namespace thimble {
namespace {

// Dark mode included; figures keep their own white ground.
constexpr std::string_view kStyle = R"(
:root { color-scheme: light dark; --ink: #1d2329; --soft: #5b6670; --line: #d5dae0; --ground: #ffffff; --tint: #f4f6f8; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6e9ec; --soft: #a3adb7; --line: #3a434c; --ground: #16191d; --tint: #1f242a; }
}
body { font: 16px/1.5 system-ui, "DejaVu Sans", Helvetica, Arial, sans-serif; color: var(--ink); background: var(--ground);
  max-width: 1180px; margin: 0 auto; padding: 1.5rem 1rem 4rem; }
h1 { font-size: 1.7rem; } h2 { font-size: 1.3rem; margin-top: 3rem; border-bottom: 1px solid var(--line); }
h3 { font-size: 1.05rem; margin: 2rem 0 .4rem; }
.answer { font-size: 1.1rem; border-left: 5px solid #0072B2; background: var(--tint); padding: .3rem 1rem; margin: .6rem 0; }
.answer p { margin: .5rem 0; } .answer h3 { margin: .4rem 0 0; }
.legend { display: grid; grid-template-columns: max-content 1fr; gap: .1rem 1rem; font-size: .92rem; }
.legend dt { font-weight: bold; } .legend dd { margin: 0; color: var(--soft); }
.problem { border-left: 5px solid #D55E00; background: var(--tint); padding: .5rem 1rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: .92rem; font-variant-numeric: tabular-nums; }
th, td { padding: .25rem .8rem; border-bottom: 1px solid var(--line); text-align: left; vertical-align: top; }
th { border-bottom: 2px solid var(--soft); } td.number { text-align: right; white-space: nowrap; }
figure { margin: 1rem 0 2rem; } figure svg { max-width: 100%; height: auto; background: #ffffff; }
.finding { max-width: 62rem; }
figcaption, .note { color: var(--soft); font-size: .88rem; max-width: 62rem; }
@page { margin: 15mm; }
@media print {
  :root { color-scheme: light; --ink: #000000; --soft: #333333; --line: #999999; --ground: #ffffff; --tint: #ffffff; }
  body { font-size: 10pt; max-width: none; margin: 0; padding: 0; }
  h1, h2, h3 { break-after: avoid; } .figure, figure, .answer, .problem, tr { break-inside: avoid; }
  figure svg { max-height: 205mm; } .wide { overflow: visible; } table { font-size: 7.5pt; }
  th, td { padding: .1rem .35rem; } thead { display: table-header-group; } p { orphans: 3; widows: 3; }
}
)";

// Characters, not bytes: UTF-8's continuation bytes take no room.
std::size_t width_of(std::string_view text) {
    const auto continues = [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; };
    return text.size() - static_cast<std::size_t>(std::count_if(text.begin(), text.end(), continues));
}

bool looks_like_number(std::string_view text) {
    return !text.empty() && text.find_first_of("0123456789") != std::string_view::npos &&
           text.find_first_not_of("0123456789.,+- %±eE") == std::string_view::npos;
}

std::string cells(const std::vector<std::string>& texts, bool head) {
    std::string row = "<tr>";
    for (const std::string& text : texts) {
        if (head) {
            row += html_element("th", text);
        } else if (looks_like_number(text) || text == "–") {
            row += fmt::format("<td class=\"number\">{}</td>", html_escape(text));
        } else {
            row += html_element("td", text);
        }
    }
    return row + "</tr>\n";
}

}  // namespace

void drop_empty_columns(ReportTable& table) {
    if (table.rows.empty()) return;
    for (std::size_t column = table.columns.size(); column-- > 0;) {
        const auto empty = [&](const std::vector<std::string>& row) { return row[column] == kDash; };
        if (!std::all_of(table.rows.begin(), table.rows.end(), empty)) continue;
        const auto place = static_cast<std::ptrdiff_t>(column);
        table.columns.erase(table.columns.begin() + place);
        for (auto& row : table.rows) row.erase(row.begin() + place);
    }
}

std::string html_escape(std::string_view text) {
    std::string escaped(text);
    for (const auto& [raw, entity] :
         {std::pair{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}})
        boost::replace_all(escaped, raw, entity);
    return escaped;
}

std::string html_element(std::string_view tag, std::string_view text) {
    return fmt::format("<{0}>{1}</{0}>", tag, html_escape(text));
}

std::string html_table(const ReportTable& table) {
    std::string html = html_element("h3", table.title) + "\n<div class=\"wide\"><table>\n<thead>";
    html += cells(table.columns, true) + "</thead>\n<tbody>\n";
    for (const auto& row : table.rows) {
        assert(row.size() == table.columns.size());
        html += cells(row, false);
    }
    html += "</tbody></table></div>\n";
    if (!table.note.empty()) html += fmt::format("<p class=\"note\">{}</p>\n", html_escape(table.note));
    return html;
}

std::string plain_table(const ReportTable& table) {
    std::vector<std::vector<std::string>> lines{table.columns};
    lines.insert(lines.end(), table.rows.begin(), table.rows.end());
    std::vector<std::size_t> widths(table.columns.size(), 0);
    for (const auto& line : lines) {
        for (std::size_t i = 0; i < line.size(); ++i) widths[i] = std::max(widths[i], width_of(line[i]));
    }
    std::string text = table.title + "\n";
    for (const auto& line : lines) {
        std::string padded;
        for (std::size_t i = 0; i < line.size(); ++i) {
            padded += "  " + line[i] + std::string(widths[i] - width_of(line[i]), ' ');
        }
        padded.erase(padded.find_last_not_of(' ') + 1);
        text += padded + "\n";
    }
    return text + (table.note.empty() ? "" : "  " + table.note + "\n");
}

std::string html_page(std::string_view title, std::string_view body) {
    return fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n"
        "<style>{}</style>\n</head>\n<body>\n{}</body>\n</html>\n",
        html_escape(title), kStyle, body);
}

}  // namespace thimble
