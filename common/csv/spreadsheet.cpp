#include <algorithm>
#include <charconv>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "common/csv/csv.hpp"
#include "common/decimal_text.hpp"
#include "common/error.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

bool is_number(std::string_view text) {
    while (text.ends_with(' ') || text.ends_with('\t')) text.remove_suffix(1);
    const std::size_t begin = text.find_first_not_of(" \t");
    if (begin == std::string_view::npos) return false;
    text.remove_prefix(begin);
    if (text.front() == '+') text.remove_prefix(1);
    double value = 0;
    const auto [rest, error] = read_decimal(text.data(), text.data() + text.size(), value);
    return error == std::errc{} && rest == text.data() + text.size();
}

void drop_byte_order_mark(std::string& text, std::string_view name) {
    if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
        throw Error(ExitCode::kData, "{}:1: is UTF-16 text: save it as CSV in UTF-8", name);
    if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
}

void drop_carriage_returns(std::string& text) {
    if (text.find('\r') == std::string::npos) return;
    std::string plain;
    plain.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i)
        if (text[i] != '\r' || (i + 1 < text.size() && text[i + 1] != '\n')) plain += text[i];
    text = std::move(plain);
}

bool is_comment(std::string_view line) {
    const std::size_t first = line.find_first_not_of(" \t");
    return first != std::string_view::npos && line[first] == '#';
}

// The first line that is neither empty nor a comment.
std::string_view header_of(std::string_view text) {
    while (!text.empty()) {
        const std::string_view line = take_until(text, '\n');
        if (line.find_first_not_of(" \t") != std::string_view::npos && !is_comment(line)) return line;
    }
    return {};
}

// Writes the fields of a table with semicolons anew.
class Rewriter {
  public:
    Rewriter(std::string_view name, char separator) : name_(name), separator_(separator) {}

    std::string rewrite(std::string_view text) {
        plain_.reserve(text.size());
        while (!text.empty()) {
            const bool ends = text.find('\n') != std::string_view::npos;
            std::string_view line = take_until(text, '\n');
            ++line_;
            if (is_comment(line)) {
                plain_ += line;
            } else {
                add_fields(line);
            }
            if (ends) plain_ += '\n';
        }
        return std::move(plain_);
    }

  private:
    void add_fields(std::string_view line) {
        for (;;) {
            const bool more = line.find(';') != std::string_view::npos;
            add_field(take_until(line, ';'));
            if (!more) return;
            plain_ += separator_;
        }
    }

    void add_field(std::string_view field) {
        std::string text(field);
        const bool has_point = text.find('.') != std::string::npos;
        if (text.find(',') != std::string::npos) {
            std::replace(text.begin(), text.end(), ',', '.');
            if (has_point || !is_number(text))
                fail(fmt::format(
                    "'{}' has a comma, but not as a decimal comma: fields are separated by semicolons here",
                    field));
            comma_line_ = line_;
        } else if (has_point && is_number(text)) {
            point_line_ = line_;
        }
        if (comma_line_ > 0 && point_line_ > 0)
            fail(fmt::format(
                "'{}': line {} has a decimal comma and line {} a decimal point: write all numbers in one way",
                field, comma_line_, point_line_));
        plain_ += text;
    }

    [[noreturn]] void fail(std::string_view why) const {
        throw Error(ExitCode::kData, "{}:{}: {}", name_, line_, why);
    }

    std::string_view name_;
    char separator_;
    std::string plain_;
    std::size_t line_ = 0, comma_line_ = 0, point_line_ = 0;
};

}  // namespace

std::string plain_table(std::string text, std::string_view name, char separator, Semicolons semicolons) {
    drop_byte_order_mark(text, name);
    drop_carriage_returns(text);
    const std::string_view header = header_of(text);
    if (header.find(';') == std::string_view::npos || header.find(separator) != std::string_view::npos)
        return text;
    if (semicolons == Semicolons::kRefuse)
        throw Error(ExitCode::kData,
                    "{}:{}: a spreadsheet program has saved this file with semicolons between its fields, "
                    "and lines are to be added: save it with {} between the fields",
                    name, 1 + std::count(std::as_const(text).data(), header.data(), '\n'),
                    separator == '\t' ? "tabs" : "commas");
    return Rewriter(name, separator).rewrite(text);
}

}  // namespace thimble
