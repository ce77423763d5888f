// A line of text without allocation: views write some thirty of them in each frame. A text that is too long is cut.
#pragma once

#include <array>
#include <string_view>

#include <fmt/format.h>

namespace thimble {

class TextLine {
  public:
    TextLine() = default;

    template <class... Values>
    static TextLine of(fmt::format_string<Values...> format, Values&&... values) {
        TextLine line;
        const auto end = fmt::format_to_n(line.text_.data(), line.text_.size() - 1, format,
                                          std::forward<Values>(values)...);
        *end.out = '\0';
        return line;
    }

    const char* c_str() const { return text_.data(); }
    std::string_view view() const { return text_.data(); }

  private:
    std::array<char, 96> text_{};
};

}  // namespace thimble
