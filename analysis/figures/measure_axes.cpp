#include "analysis/figures/measure_axes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <boost/algorithm/string/replace.hpp>
#include <boost/algorithm/string/split.hpp>
#include <fmt/format.h>

#include "analysis/statistics/descriptive.hpp"
#include "analysis/text/gnuplot.hpp"
#include "common/math/portable.hpp"

namespace thimble {
namespace {

bool is_number(double value) { return std::isfinite(value); }

bool has_numbers(const NamedValues& column) {
    return std::any_of(column.values.begin(), column.values.end(), is_number);
}

struct ValueRange {
    double low = 0, high = 0;  // zero if there is no number
};

ValueRange range_of(std::span<const double> values) {
    ValueRange range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const double value : values) {
        if (!is_number(value)) continue;
        range.low = std::min(range.low, value);
        range.high = std::max(range.high, value);
    }
    return range.low > range.high ? ValueRange{} : range;
}

// 1, 2, 5 of each decade, of more than three decades 1 alone. Decades alone would leave some panels with one number.
std::string decade_tics(const ValueRange& range) {
    const int first = static_cast<int>(std::floor(portable::log10(range.low))),
              last = static_cast<int>(std::ceil(portable::log10(range.high)));
    std::string tics;
    for (int decade = first; decade <= last; ++decade) {
        for (const int digit : {1, 2, 5}) {
            if (digit > 1 && last - first > 3) continue;
            tics += fmt::format("{}{:.6g}", tics.empty() ? "" : ", ", digit * portable::pow(10, decade));
        }
    }
    return tics;
}

std::string logarithmic_axis(const ValueRange& range) {
    constexpr double kRoom = 1.15;
    return fmt::format("set logscale y; set ytics ({}); set yrange [{:.6g}:{:.6g}]\n", decade_tics(range),
                       range.low / kRoom, range.high * kRoom);
}

// Starts at zero, so that sizes compare, unless there are values below it.
std::string linear_axis(const ValueRange& range) {
    double low = std::min(0.0, range.low), high = std::max(0.0, range.high);
    if (low == high) high = 1;
    const double room = 0.06 * (high - low);
    if (low < 0) low -= room;
    return fmt::format("unset logscale y; set ytics {:.6g}; set yrange [{:.6g}:{:.6g}]\n",
                       nice_step(high - low, 8), low, high + room);
}

std::string in_lines(const std::string& name) {
    constexpr std::size_t kLong = 12;
    std::string lines;
    std::size_t length = 0;
    for (const char c : name) {
        if (c == '+') lines += '\n';
        lines += c;
        length = c == '+' ? 1 : length + 1;
        if (c != '-' || length < kLong) continue;
        lines += '\n';
        length = 0;
    }
    return lines;
}

}  // namespace

std::string place_axis(const std::vector<AxisPlace>& places) {
    std::string tics;
    for (std::size_t i = 0; i < places.size(); ++i) {
        tics += fmt::format("{}\"{}\\n{{/*0.85 n = {}}}\" {}", i > 0 ? ", " : "",
                            boost::replace_all_copy(places[i].name, "\n", "\\n"), places[i].n, i);
    }
    return fmt::format("set xrange [-0.6:{:.1f}]; set xtics scale 0 ({})\n",
                       static_cast<double>(places.size()) - 0.4, tics);
}

std::vector<AxisPlace> places_of(const std::vector<NamedValues>& columns) {
    std::vector<AxisPlace> places;
    places.reserve(columns.size());
    for (const NamedValues& column : columns) {
        const auto n = std::count_if(column.values.begin(), column.values.end(), is_number);
        places.push_back({in_lines(column.name), std::to_string(n)});
    }
    return places;
}

FigureGrid measure_grid(std::size_t measures, const std::vector<AxisPlace>& places) {
    constexpr int kCharacterWidth_px = 8, kLineHeight_px = 19, kNarrow_px = 260, kAlone_px = 480;
    std::size_t longest = 0;
    std::ptrdiff_t breaks = 0;
    for (const AxisPlace& place : places) {
        std::vector<std::string> lines;
        boost::split(lines, place.name, [](char c) { return c == '\n'; });
        for (const std::string& line : lines) longest = std::max(longest, line.size());
        breaks = std::max(breaks, std::ssize(lines) - 1);
    }
    const int names_px = static_cast<int>(places.size() * (longest + 1)) * kCharacterWidth_px;
    FigureGrid grid;
    grid.columns = measures;
    grid.panel_width_px = std::max(measures == 1 ? kAlone_px : kNarrow_px, names_px);
    grid.foot_px += kLineHeight_px * static_cast<int>(breaks);
    return grid;
}

void write_shown(std::string& data, double value, Metric metric) {
    write_cell(data, value * info(metric).shown_per_si);
}

bool wants_logarithm(std::span<const double> values) {
    constexpr double kFarOut = 5;
    NamedValues numbers{"values", {}};
    for (const double value : values) {
        if (!is_number(value)) continue;
        if (value <= 0) return false;
        numbers.values.push_back(value);
    }
    if (numbers.values.empty()) return false;
    const double largest = *std::max_element(numbers.values.begin(), numbers.values.end());
    return largest > kFarOut * sample_median(numbers);
}

std::string vertical_axis(std::span<const double> values, bool logarithmic) {
    const ValueRange range = range_of(values);
    return logarithmic && range.low > 0 ? logarithmic_axis(range) : linear_axis(range);
}

std::string measure_axis(Metric metric, std::span<const double> values) {
    const bool logarithm = wants_logarithm(values);
    std::vector<double> shown(values.begin(), values.end());
    for (double& value : shown) value *= info(metric).shown_per_si;
    return fmt::format("set ylabel '{}{}'\n", info(metric).label, logarithm ? ", log" : "") +
           vertical_axis(shown, logarithm);
}

std::string signed_axis(std::span<const double> values) {
    const ValueRange range = range_of(values);
    double low = std::min(0.0, range.low), high = std::max(0.0, range.high);
    if (low == high) low = -1, high = 1;
    const double room = 0.05 * (high - low);
    return fmt::format("set xtics {:.6g}; set xrange [{:.6g}:{:.6g}]\n", nice_step(high - low, 6), low - room,
                       high + room);
}

double nice_step(double span, double most) {
    const double decade = portable::pow(10, std::floor(portable::log10(span / most)));
    for (const double digit : {1.0, 2.0, 5.0}) {
        if (span <= most * digit * decade) return digit * decade;
    }
    return 10 * decade;
}

std::vector<double> values_of(const std::vector<NamedValues>& columns) {
    std::vector<double> values;
    for (const NamedValues& column : columns)
        values.insert(values.end(), column.values.begin(), column.values.end());
    return values;
}

std::vector<std::vector<NamedValues>> present_columns(std::vector<std::vector<NamedValues>> measures) {
    std::vector<std::string> absent;
    for (std::size_t i = 0; !measures.empty() && i < measures[0].size(); ++i) {
        if (std::none_of(measures.begin(), measures.end(),
                         [i](const auto& columns) { return has_numbers(columns[i]); }))
            absent.push_back(measures[0][i].name);
    }
    if (!measures.empty() && absent.size() == measures[0].size()) return measures;
    for (std::vector<NamedValues>& columns : measures) {
        std::erase_if(columns, [&](const NamedValues& column) {
            return std::find(absent.begin(), absent.end(), column.name) != absent.end();
        });
    }
    return measures;
}

}  // namespace thimble
