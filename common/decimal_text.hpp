// Numbers in text: the whole text, or nothing. It also reads a double where std::from_chars cannot
// (LLVM's library, in the browser).
#pragma once

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace thimble {

// As std::from_chars in its general format. Without it nothing but finite decimals is read.
inline std::from_chars_result read_decimal(const char* first, const char* last, double& value) {
#ifdef __cpp_lib_to_chars
    return std::from_chars(first, last, value);
#else
    const std::string text(first, last);
    const std::size_t length = std::min(text.find_first_not_of("+-.0123456789eE"), text.size());
    const std::string number = text.substr(0, length);
    char* end = nullptr;
    const double read = std::strtod(number.c_str(), &end);
    if (end == number.c_str() || number[0] == '+') return {first, std::errc::invalid_argument};
    if (!std::isfinite(read)) return {first + (end - number.c_str()), std::errc::result_out_of_range};
    value = read;
    return {first + (end - number.c_str()), std::errc{}};
#endif
}

// The whole text as a whole number that `Number` can hold.
template <class Number>
std::optional<Number> parse_whole(std::string_view text, int base = 10) {
    Number value = 0;
    const char* const last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), last, value, base);
    if (error != std::errc{} || end != last) return {};
    return value;
}

// The whole text as a finite decimal number.
inline std::optional<double> parse_number(std::string_view text) {
    double value = 0;
    const char* const last = text.data() + text.size();
    const auto [end, error] = read_decimal(text.data(), last, value);
    if (error != std::errc{} || end != last || !std::isfinite(value)) return {};
    return value;
}

}  // namespace thimble
