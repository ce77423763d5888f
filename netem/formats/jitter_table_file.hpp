// iproute2's .dist files: whole numbers in rising order, 8192 to a standard deviation, lines of '#' are comments.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "common/decimal_text.hpp"
#include "common/error.hpp"
#include "common/text_file.hpp"
#include "netem/formats/text_lines.hpp"
#include "netem/jitter_table.hpp"

namespace thimble {

inline constexpr double kDistScale = 8192;             // of one spread (NETEM_DIST_SCALE)
inline constexpr std::size_t kMostDistValues = 16384;  // as tc takes; its own tables have 4096

inline constexpr std::int64_t kLeastDistValue = -32768, kMostDistValue = 32767;

inline double deviate_of(std::string_view word, const LineReader& lines) {
    const auto value = parse_whole<std::int64_t>(word);
    if (!value || *value < kLeastDistValue || *value > kMostDistValue) {
        lines.fail("'{}' is not a whole number from {} to {}", word.substr(0, 40), kLeastDistValue,
                   kMostDistValue);
    }
    return static_cast<double>(*value) / kDistScale;
}

// Throws Error (data) with file and line for what is no table: fewer than two values, a value outside of
// -32768 to 32767. Values in any order are sorted, since tc draws them at random.
inline JitterTable parse_jitter_table(std::string_view text, std::string_view name) {
    std::vector<double> deviates;
    LineReader lines(text, name);
    while (lines.next()) {
        if (!lines.line().empty() && lines.line().front() == '#') continue;
        for (const std::string_view word : words_of(lines.line())) {
            if (deviates.size() == kMostDistValues) {
                lines.fail("more than {} values; tc takes no more", kMostDistValues);
            }
            deviates.push_back(deviate_of(word, lines));
        }
    }
    if (deviates.size() < 2) {
        fail_at_line(name, std::max<std::size_t>(1, lines.number()), "a table needs at least two values");
    }
    std::sort(deviates.begin(), deviates.end());
    return JitterTable(std::move(deviates));
}

// A path, or the name of a table in tc's folders (TC_LIB_DIR, then where distributions install it).
inline std::shared_ptr<const JitterTable> find_jitter_table(std::string_view name) {
    std::vector<std::filesystem::path> places{std::filesystem::path(name)};
    if (name.find('/') == std::string_view::npos) {
        const std::string file = std::string(name) + ".dist";
        places.emplace_back(file);
        if (const char* folder = std::getenv("TC_LIB_DIR"))
            places.push_back(std::filesystem::path(folder) / file);
        for (const char* folder : {"/usr/lib/x86_64-linux-gnu/tc", "/usr/lib/aarch64-linux-gnu/tc",
                                   "/usr/lib/tc", "/usr/lib64/tc", "/usr/share/tc"}) {
            places.push_back(std::filesystem::path(folder) / file);
        }
    }
    for (const auto& place : places) {
        if (std::filesystem::is_regular_file(place)) {
            return std::make_shared<const JitterTable>(
                parse_jitter_table(read_whole_file(place, std::size_t{1} << 20), place.string()));
        }
    }
    throw Error(ExitCode::kUsage,
                "distribution '{}': use uniform, normal, pareto or paretonormal, or a .dist file here or in "
                "tc's folders (TC_LIB_DIR)",
                name);
}

// `values` of them, at the middle of equal shares, as tc's own tables are made. Values beyond 4 spreads are cut,
// because a value has 16 bits.
inline std::string print_jitter_table(const JitterTable& table, std::string_view comment,
                                      std::size_t values = 4096) {
    std::string text = "# " + std::string(comment);
    std::replace(text.begin(), text.end(), '\n', ' ');
    for (std::size_t i = 0; i < values; ++i) {
        const double u = (static_cast<double>(i) + 0.5) / static_cast<double>(values);
        const std::int64_t value = std::llround(kDistScale * table.quantile(u));
        text += i % 8 == 0 ? '\n' : ' ';
        text += fmt::format("{}", std::clamp(value, kLeastDistValue, kMostDistValue));
    }
    return text + '\n';
}

}  // namespace thimble
