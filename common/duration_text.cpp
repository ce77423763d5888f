#include "common/duration_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "common/decimal_text.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

struct Unit {
    std::string_view name;
    int power_of_ten;
    double times;
};
constexpr std::array<Unit, 8> kUnits{{{"ns", -9, 1},
                                      {"us", -6, 1},
                                      {"\u00b5s", -6, 1},  // micro sign
                                      {"\u03bcs", -6, 1},  // Greek mu
                                      {"ms", -3, 1},
                                      {"s", 0, 1},
                                      {"min", 0, 60},
                                      {"h", 0, 3600}}};

constexpr int kMostPower = 10'000;

// The number that `text` begins with, cut off from it.
std::optional<double> take_number(std::string_view& text) {
    double value = 0;
    const auto [end, error] = read_decimal(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || !std::isfinite(value)) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return value;
}

// A decimal point that moves keeps every bit, and a division does not.
std::optional<double> with_power(std::string_view number, int power_of_ten) {
    const std::size_t mark = number.find_first_of("eE");
    int power = 0;
    if (mark != std::string_view::npos) {
        std::string_view digits = number.substr(mark + 1);
        if (digits.starts_with('+')) digits.remove_prefix(1);
        std::from_chars(digits.data(), digits.data() + digits.size(), power);
        power = std::clamp(power, -kMostPower, kMostPower);  // of zero, which any power leaves
    }
    const std::string moved = fmt::format("{}e{}", number.substr(0, mark), power + power_of_ten);
    std::string_view rest = moved;
    return take_number(rest);
}

bool is_network_time(std::string_view name) {
    for (const std::string_view part : {"delay", "jitter", "slot"})
        if (name.find(part) != std::string_view::npos) return true;
    return false;
}

std::string milliseconds_instead(double seconds) {
    return fmt::format("for {} ms write {} or \"{}ms\"", seconds, seconds / 1000, seconds);
}

// One number of an option's word. The option itself refuses any other word.
std::string settle_one(std::string_view name, std::string_view part, std::string& settled) {
    if (part.starts_with('+')) part.remove_prefix(1);
    std::string_view rest = part;
    const auto number = take_number(rest);
    if (number && rest.empty()) {
        settled += part;
        return doubt_seconds(name, *number);
    }
    const auto seconds = parse_duration(part);
    settled += seconds ? fmt::format("{}", *seconds) : std::string(part);
    if (!number || seconds) return {};
    return fmt::format("'{}' has an unknown unit: write seconds, or a number with {}, e.g. 50ms", part,
                       kDurationUnits);
}

}  // namespace

std::optional<double> parse_duration(std::string_view text) {
    if (text.starts_with('+')) text.remove_prefix(1);
    std::string_view rest = text;
    if (!take_number(rest)) return std::nullopt;
    const std::string_view number = text.substr(0, text.size() - rest.size());
    if (rest.starts_with(' ')) rest.remove_prefix(1);
    for (const Unit& unit : kUnits) {
        if (rest != unit.name) continue;
        const auto value = with_power(number, unit.power_of_ten);
        if (!value || !std::isfinite(*value * unit.times)) return std::nullopt;
        return *value * unit.times;
    }
    return std::nullopt;
}

bool holds_seconds(std::string_view name) {
    if (name.ends_with("_s")) return !name.ends_with("_per_s");
    if (name.ends_with("-s")) return !name.ends_with("-per-s");
    return name.ends_with("seconds");
}

std::string doubt_seconds(std::string_view name, double seconds) {
    if (seconds < kLongestPath_s || !holds_seconds(name) || !is_network_time(name)) return {};
    return fmt::format("{0}, but no network takes {0} s: {1}; for {0} s write \"{0}s\"", seconds,
                       milliseconds_instead(seconds));
}

std::string meant_milliseconds(std::string_view name, double seconds, double low, double high) {
    const bool could_be =
        holds_seconds(name) && seconds > high && seconds / 1000 >= low && seconds / 1000 <= high;
    return could_be ? "; " + milliseconds_instead(seconds) : "";
}

std::string settle_durations(std::string_view name, std::string& word) {
    std::string settled;
    std::vector<std::string_view> items, parts;
    split_at(',', word, items);
    for (const std::string_view item : items) {
        split_at(':', item, parts);
        for (std::size_t i = 0; i < parts.size(); ++i) {
            if (i == 2) {  // how many points
                settled += parts[i];
            } else if (std::string wrong = settle_one(name, parts[i], settled); !wrong.empty()) {
                return wrong;
            }
            settled += i + 1 < parts.size() ? ':' : ',';
        }
    }
    settled.pop_back();
    word = settled;
    return {};
}

}  // namespace thimble
