#include "netem/formats/tc_units.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "netem/formats/text_lines.hpp"

namespace thimble {
namespace {

struct TcQuantity {
    std::string_view number;
    std::string unit;  // in small letters, as tc compares them
};

std::optional<TcQuantity> split(std::string_view word) {
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || !std::isfinite(value)) return {};
    const auto digits = static_cast<std::size_t>(end - word.data());
    TcQuantity quantity{word.substr(0, digits), std::string(word.substr(digits))};
    for (char& c : quantity.unit) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return quantity;
}

// number * 10^power, rounded once: the decimal point moves in the text. 0.1 % is then the double next to 0.001.
std::optional<double> shifted(std::string_view number, int power) {
    const std::size_t e = number.find_first_of("eE");
    std::string_view exponent = e == std::string_view::npos ? "0" : number.substr(e + 1);
    if (!exponent.empty() && exponent.front() == '+') exponent.remove_prefix(1);
    const auto given = parse_integer(exponent);
    if (!given || std::abs(*given) > 400) return {};
    return parse_number(fmt::format("{}e{}", number.substr(0, e), *given + power));
}

// value * 10^power as plain decimals, without loss.
std::string print_shifted(double value, int power) {
    if (value == 0) return "0";
    std::array<char, 64> buffer{};
    const auto end =
        std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::scientific).ptr;
    const std::string_view text(buffer.data(), static_cast<std::size_t>(end - buffer.data()));
    const std::size_t e = text.find('e');
    std::string digits(text.substr(0, e));
    digits.erase(std::remove(digits.begin(), digits.end(), '.'), digits.end());
    std::string_view exponent = text.substr(e + 1);
    if (exponent.front() == '+') exponent.remove_prefix(1);
    const int point = static_cast<int>(*parse_integer(exponent)) + power + 1;  // digits before the point
    if (point <= 0) return "0." + std::string(static_cast<std::size_t>(-point), '0') + digits;
    if (point >= static_cast<int>(digits.size())) {
        return digits + std::string(static_cast<std::size_t>(point) - digits.size(), '0');
    }
    return digits.insert(static_cast<std::size_t>(point), 1, '.');
}

struct Unit {
    std::string_view name;
    int power;          // of ten
    double factor = 1;  // beyond that; powers of two are exact
};

template <std::size_t n>
std::optional<double> in_units(std::string_view word, const std::array<Unit, n>& units) {
    const auto quantity = split(word);
    if (!quantity) return {};
    const auto unit = std::find_if(units.begin(), units.end(),
                                   [&](const Unit& known) { return known.name == quantity->unit; });
    if (unit == units.end()) return {};
    const auto value = shifted(quantity->number, unit->power);
    if (!value || !(*value >= 0)) return {};
    return *value * unit->factor;
}

constexpr double kKi = 1024, kMi = 1024 * kKi, kGi = 1024 * kMi, kTi = 1024 * kGi;

}  // namespace

std::optional<Duration> parse_tc_time(std::string_view word, Duration bare) {
    constexpr double kMost_ns = 3600e9;
    const std::array<Unit, 13> nanoseconds{{{"", bare == Duration{1} ? 0 : 3},
                                            {"s", 9},
                                            {"sec", 9},
                                            {"secs", 9},
                                            {"ms", 6},
                                            {"msec", 6},
                                            {"msecs", 6},
                                            {"us", 3},
                                            {"usec", 3},
                                            {"usecs", 3},
                                            {"ns", 0},
                                            {"nsec", 0},
                                            {"nsecs", 0}}};
    const auto value = in_units(word, nanoseconds);
    if (!value || *value > kMost_ns) return {};
    return Duration{std::llround(*value)};
}

std::optional<double> parse_tc_share(std::string_view word) {
    constexpr std::array<Unit, 2> kShares{{{"", -2}, {"%", -2}}};
    const auto share = in_units(word, kShares);
    if (!share || *share > 1) return {};
    return share;
}

std::optional<double> parse_tc_rate(std::string_view word) {
    constexpr double kMost_bits_per_s = 1e12;
    constexpr std::array<Unit, 19> kRates{{{"", 0},
                                           {"bit", 0},
                                           {"kbit", 3},
                                           {"mbit", 6},
                                           {"gbit", 9},
                                           {"tbit", 12},
                                           {"kibit", 0, kKi},
                                           {"mibit", 0, kMi},
                                           {"gibit", 0, kGi},
                                           {"tibit", 0, kTi},
                                           {"bps", 0, 8},
                                           {"kbps", 3, 8},
                                           {"mbps", 6, 8},
                                           {"gbps", 9, 8},
                                           {"tbps", 12, 8},
                                           {"kibps", 0, 8 * kKi},
                                           {"mibps", 0, 8 * kMi},
                                           {"gibps", 0, 8 * kGi},
                                           {"tibps", 0, 8 * kTi}}};
    const auto rate = in_units(word, kRates);
    if (!rate || *rate > kMost_bits_per_s) return {};
    return rate;
}

std::optional<std::size_t> parse_tc_size(std::string_view word) {
    constexpr double kMost_bytes = 4294967295.0;  // tc keeps sizes in 32 bits
    constexpr std::array<Unit, 11> kSizes{{{"", 0},
                                           {"b", 0},
                                           {"k", 0, kKi},
                                           {"kb", 0, kKi},
                                           {"m", 0, kMi},
                                           {"mb", 0, kMi},
                                           {"g", 0, kGi},
                                           {"gb", 0, kGi},
                                           {"kbit", 0, kKi / 8},
                                           {"mbit", 0, kMi / 8},
                                           {"gbit", 0, kGi / 8}}};
    const auto size = in_units(word, kSizes);
    if (!size || *size > kMost_bytes) return {};
    return static_cast<std::size_t>(*size);
}

std::string print_tc_time(Duration time) {
    const std::int64_t ns = time.count();
    if (ns % 1'000'000'000 == 0) return fmt::format("{}s", ns / 1'000'000'000);
    if (ns % 1'000'000 == 0) return fmt::format("{}ms", ns / 1'000'000);
    if (ns % 1000 == 0) return fmt::format("{}us", ns / 1000);
    return print_shifted(static_cast<double>(ns), -3) + "us";
}

std::string print_tc_share(double share) { return print_shifted(share, 2) + "%"; }

std::string print_tc_rate(double bits_per_s) {
    if (bits_per_s >= 1e9) return print_shifted(bits_per_s, -9) + "gbit";
    if (bits_per_s >= 1e6) return print_shifted(bits_per_s, -6) + "mbit";
    if (bits_per_s >= 1e3) return print_shifted(bits_per_s, -3) + "kbit";
    return print_shifted(bits_per_s, 0) + "bit";
}

}  // namespace thimble
