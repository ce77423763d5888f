#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "common/decimal_text.hpp"
#include "netem/formats/tc_text.hpp"

namespace thimble {
namespace {

// number * 10^power, rounded once: the decimal point moves in the text. 0.1 % is then the double next to 0.001.
std::optional<double> shifted(std::string_view number, int power) {
    const std::size_t e = number.find_first_of("eE");
    std::string_view exponent = e == std::string_view::npos ? "0" : number.substr(e + 1);
    if (!exponent.empty() && exponent.front() == '+') exponent.remove_prefix(1);
    const auto given = parse_whole<std::int64_t>(exponent);
    if (!given || std::abs(*given) > 400) return {};
    return parse_number(fmt::format("{}e{}", number.substr(0, e), *given + power));
}

// value * 10^power as plain decimals, without loss.
std::string print_shifted(double value, int power) {
    if (value == 0) return "0";
    std::string shortest;
    for (int digits = 0; parse_number(shortest) != value; ++digits)
        shortest = fmt::format("{:.{}e}", value, digits);
    const std::size_t e = shortest.find('e');
    std::string digits(shortest.substr(0, e));
    std::erase(digits, '.');
    const bool signless = shortest[e + 1] == '+';
    const auto exponent = *parse_whole<std::int64_t>(shortest.substr(e + (signless ? 2 : 1)));
    const auto point = static_cast<std::ptrdiff_t>(exponent + power + 1);  // digits before it
    if (point <= 0) return "0." + std::string(static_cast<std::size_t>(-point), '0') + digits;
    const auto before = static_cast<std::size_t>(point);
    if (before >= digits.size()) return digits + std::string(before - digits.size(), '0');
    return digits.insert(before, 1, '.');
}

struct TcQuantity {
    std::string_view number;
    std::string unit;  // in small letters, as tc compares them

    // Takes `ending` off the unit, if it is there.
    bool cut(std::string_view ending) {
        if (!unit.ends_with(ending)) return false;
        unit.resize(unit.size() - ending.size());
        return true;
    }
    // The power of a thousand that is left of the unit: "", "k", "m", "g" or "t".
    std::optional<int> thousands() const {
        const std::size_t place = std::string_view("kmgt").find(unit);
        if (unit.size() > 1 || place == std::string_view::npos) return {};
        return unit.empty() ? 0 : static_cast<int>(place) + 1;
    }
    // Exact for factors that are powers of two. Nothing if it is below 0 or above `most`.
    std::optional<double> value(int power, double factor, double most) const {
        const auto plain = shifted(number, power);
        if (!plain || !(*plain >= 0) || *plain * factor > most) return {};
        return *plain * factor;
    }
};

std::optional<TcQuantity> split(std::string_view word) {
    double value = 0;
    const auto [end, error] = read_decimal(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || !std::isfinite(value)) return {};
    const auto digits = static_cast<std::size_t>(end - word.data());
    TcQuantity quantity{word.substr(0, digits), std::string(word.substr(digits))};
    for (char& c : quantity.unit) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return quantity;
}

}  // namespace

std::optional<Duration> parse_tc_time(std::string_view word, Duration bare) {
    constexpr double kMost_ns = 3600e9;
    constexpr std::array<std::pair<std::string_view, int>, 4> kPowers{
        {{"s", 9}, {"ms", 6}, {"us", 3}, {"ns", 0}}};
    auto time = split(word);
    if (!time) return {};
    if (time->unit.empty()) time->unit = bare == Duration{1} ? "ns" : "us";
    if (time->cut("secs") || time->cut("sec")) time->unit += 's';
    const auto known = std::find_if(kPowers.begin(), kPowers.end(),
                                    [&](const auto& power) { return power.first == time->unit; });
    if (known == kPowers.end()) return {};
    const auto value_ns = time->value(known->second, 1, kMost_ns);
    return value_ns ? std::optional(Duration{std::llround(*value_ns)}) : std::nullopt;
}

std::optional<double> parse_tc_share(std::string_view word) {
    auto share = split(word);
    if (share) share->cut("%");
    return share && share->unit.empty() ? share->value(-2, 1, 1) : std::nullopt;
}

std::optional<double> parse_tc_rate(std::string_view word) {
    constexpr double kMost_bits_per_s = 1e12;
    auto rate = split(word);
    if (!rate) return {};
    const double bits = rate->cut("bps") ? 8 : 1;
    if (bits == 1 && !rate->cut("bit") && !rate->unit.empty()) return {};
    const bool binary = rate->unit.size() > 1 && rate->cut("i");
    const auto thousands = rate->thousands();
    if (!thousands) return {};
    return binary ? rate->value(0, std::ldexp(bits, 10 * *thousands), kMost_bits_per_s)
                  : rate->value(3 * *thousands, bits, kMost_bits_per_s);
}

std::optional<std::size_t> parse_tc_size(std::string_view word) {
    constexpr double kMost_bytes = 4294967295.0;  // tc keeps sizes in 32 bits
    auto size = split(word);
    if (!size) return {};
    const bool bits = size->cut("bit");
    if (!bits) size->cut("b");
    const auto thousands = size->thousands();
    if (!thousands || *thousands > 3 || (bits && *thousands == 0)) return {};
    const auto bytes = size->value(0, std::ldexp(bits ? 0.125 : 1.0, 10 * *thousands), kMost_bytes);
    return bytes ? std::optional(static_cast<std::size_t>(*bytes)) : std::nullopt;
}

std::string print_tc_time(Duration time) {
    const std::int64_t ns = time.count();
    if (ns % 1'000'000'000 == 0) return fmt::format("{}s", ns / 1'000'000'000);
    if (ns % 1'000'000 == 0) return fmt::format("{}ms", ns / 1'000'000);
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
