#include "netem/formats/jitter_table_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include <fmt/format.h>

#include "common/error.hpp"
#include "netem/formats/text_lines.hpp"

namespace thimble {
namespace {

constexpr std::int64_t kLeast = -32768, kMost = 32767;
constexpr std::size_t kMostTableBytes = std::size_t{1} << 20;
constexpr std::size_t kPerLine = 8;

double deviate_of(std::string_view word, const LineReader& lines) {
    const auto value = parse_integer(word);
    if (!value || *value < kLeast || *value > kMost) {
        lines.fail("'{}' is no whole number from {} to {}", word.substr(0, 40), kLeast, kMost);
    }
    return static_cast<double>(*value) / kDistScale;
}

}  // namespace

JitterTable parse_jitter_table(std::string_view text, std::string_view name) {
    std::vector<double> deviates;
    LineReader lines(text, name);
    while (lines.next()) {
        if (!lines.line().empty() && lines.line().front() == '#') continue;
        for (const std::string_view word : words_of(lines.line())) {
            if (deviates.size() == kMostDistValues) {
                lines.fail("more than {} values, the most that tc takes", kMostDistValues);
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

std::shared_ptr<const JitterTable> find_jitter_table(std::string_view name) {
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
                parse_jitter_table(read_whole_file(place, kMostTableBytes), place.string()));
        }
    }
    throw Error(ExitCode::kUsage,
                "distribution '{}': neither uniform, normal, pareto or paretonormal nor a .dist file here or "
                "in tc's folders (TC_LIB_DIR)",
                name);
}

std::string print_jitter_table(const JitterTable& table, std::string_view comment, std::size_t values) {
    std::string text = "# " + std::string(comment);
    std::replace(text.begin(), text.end(), '\n', ' ');
    for (std::size_t i = 0; i < values; ++i) {
        const double u = (static_cast<double>(i) + 0.5) / static_cast<double>(values);
        const std::int64_t value = std::llround(kDistScale * table.quantile(u));
        text += i % kPerLine == 0 ? '\n' : ' ';
        text += fmt::format("{}", std::clamp(value, kLeast, kMost));
    }
    return text + '\n';
}

}  // namespace thimble
