// Text files from outside, line by line. An error names file and line (exit code 5).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace thimble {

// Error (data): "name:line: why".
[[noreturn]] void fail_at_line(std::string_view name, std::size_t line, std::string_view why);

// Walks over the lines of a text, without their ends (LF or CR LF) and without a byte order mark.
class LineReader {
  public:
    LineReader(std::string_view text, std::string_view name);

    bool next();  // false at the end
    std::string_view line() const { return line_; }
    std::size_t number() const { return number_; }  // the first line is 1
    [[noreturn]] void fail(std::string_view why) const { fail_at_line(name_, number_, why); }
    template <class First, class... More>
    [[noreturn]] void fail(fmt::format_string<First, More...> why, First&& first, More&&... more) const {
        fail(fmt::format(why, std::forward<First>(first), std::forward<More>(more)...));
    }

  private:
    std::string_view rest_, line_;
    std::string name_;
    std::size_t number_ = 0;
    bool at_end_ = false;
};

std::string_view trimmed(std::string_view text);  // without blanks and tabs at its ends
// Fields between commas, trimmed.
std::vector<std::string_view> fields_of(std::string_view line);

}  // namespace thimble
