#include "session/records/needle_file.hpp"

#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/text_file.hpp"

namespace thimble {

namespace {

constexpr std::string_view kTime = "time_s";
constexpr std::string_view kPosition = "position_needle_m";
constexpr std::size_t kNoColumn = std::numeric_limits<std::size_t>::max();

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view kBlank = " \t\r";
    const std::size_t first = text.find_first_not_of(kBlank);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

class Reader {
  public:
    Reader(std::string_view text, std::string_view name, const NeedleLimits& limits)
        : text_(text), name_(name), limits_(limits) {
        constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
        if (text_.substr(0, kByteOrderMark.size()) == kByteOrderMark) {
            text_.remove_prefix(kByteOrderMark.size());
        }
    }

    NeedlePath read() {
        read_header();
        NeedlePath path;
        std::string_view line;
        while (next_line(line)) append(read_sample(line), path.samples);
        if (path.samples.empty()) fail("no sample follows the header");
        return path;
    }

  private:
    [[noreturn]] void fail(std::string_view why) const {
        throw Error(ExitCode::kData, fmt::format("{}:{}: {}", name_, line_, why));
    }

    // Comments are passed over. Empty lines are only where the file ends.
    bool next_line(std::string_view& line) {
        while (!text_.empty()) {
            ++line_;
            line = trimmed(take_until(text_, '\n'));
            if (line.empty()) {
                if (trimmed_all(text_).empty()) return false;
                fail("an empty line in the middle of the recording: fill the gap or remove the line");
            }
            if (line.front() != '#') return true;
        }
        return false;
    }

    static std::string_view trimmed_all(std::string_view text) {
        const std::size_t first = text.find_first_not_of(" \t\r\n");
        return first == std::string_view::npos ? std::string_view{} : text.substr(first);
    }

    void read_header() {
        std::string_view header;
        if (!next_line(header)) {
            line_ = 1;
            fail(fmt::format("the file is empty; it must begin with the header {},{}", kTime, kPosition));
        }
        for (bool more = true; more; ++columns_) {
            more = header.find(',') != std::string_view::npos;
            const std::string_view column = trimmed(take_until(header, ','));
            if (column == kTime) find_column(kTime, time_column_);
            if (column == kPosition) find_column(kPosition, position_column_);
        }
        if (time_column_ == kNoColumn || position_column_ == kNoColumn) {
            fail(fmt::format("the header has no column {}; it must name {} and {}",
                             time_column_ == kNoColumn ? kTime : kPosition, kTime, kPosition));
        }
    }

    void find_column(std::string_view name, std::size_t& column) const {
        if (column != kNoColumn) fail(fmt::format("the header names {} twice: which one is meant?", name));
        column = columns_;
    }

    NeedlePath::Sample read_sample(std::string_view line) const {
        NeedlePath::Sample sample{0, 0, line_};
        std::size_t column = 0;
        for (bool more = true; more; ++column) {
            more = line.find(',') != std::string_view::npos;
            const std::string_view field = trimmed(take_until(line, ','));
            if (column == time_column_) sample.time_s = number(field, kTime);
            if (column == position_column_) sample.position_m = number(field, kPosition);
        }
        if (column != columns_) fail(fmt::format("has {} fields, the header {}", column, columns_));
        return sample;
    }

    double number(std::string_view field, std::string_view column) const {
        if (field.empty()) fail(fmt::format("{} is empty: fill the gap or remove the line", column));
        std::string_view digits = field;
        const bool plus = digits.front() == '+';
        if (plus) digits.remove_prefix(1);
        double value = 0;
        const char* const end = digits.data() + digits.size();
        const auto [rest, error] = std::from_chars(digits.data(), end, value);
        const bool two_signs = plus && digits.substr(0, 1) == "-";
        if (two_signs || error != std::errc{} || rest != end || !std::isfinite(value)) {
            fail(fmt::format("{} is '{}', which is not a finite number", column, field));
        }
        return value;
    }

    void append(const NeedlePath::Sample& sample, std::vector<NeedlePath::Sample>& samples) const {
        if (std::abs(sample.position_m) > limits_.farthest_m) {
            fail(fmt::format("the needle is at {} m, more than {} m away: are these metres?",
                             sample.position_m, limits_.farthest_m));
        }
        if (!samples.empty()) check_pace(samples.back(), sample);
        samples.push_back(sample);
    }

    void check_pace(const NeedlePath::Sample& before, const NeedlePath::Sample& sample) const {
        const double elapsed_s = sample.time_s - before.time_s;
        if (!(elapsed_s > 0)) {
            fail(fmt::format("time {} s does not come after {} s of line {}: times must increase",
                             sample.time_s, before.time_s, before.line));
        }
        if (elapsed_s > limits_.longest_gap_s) {
            fail(fmt::format("a gap of {} s since line {}; the longest allowed is {} s (--longest-gap-s)",
                             elapsed_s, before.line, limits_.longest_gap_s));
        }
        if (!(std::abs(sample.position_m - before.position_m) <= limits_.fastest_m_per_s * elapsed_s)) {
            fail(fmt::format("the needle would have moved {} m in {} s since line {}",
                             sample.position_m - before.position_m, elapsed_s, before.line));
        }
    }

    std::string_view text_;
    std::string_view name_;
    const NeedleLimits& limits_;
    std::size_t line_ = 0;
    std::size_t columns_ = 0;
    std::size_t time_column_ = kNoColumn;
    std::size_t position_column_ = kNoColumn;
};

}  // namespace

NeedlePath parse_needle_path(std::string_view text, std::string_view name, const NeedleLimits& limits) {
    return Reader(text, name, limits).read();
}

NeedlePath read_needle_path(const std::filesystem::path& file, const NeedleLimits& limits) {
    std::ifstream in(file, std::ios::binary);
    if (!in || std::filesystem::is_directory(file)) {
        throw Error(ExitCode::kData,
                    fmt::format("{}: cannot be read; check that the file exists and is yours to read",
                                file.string()));
    }
    const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    return parse_needle_path(text, file.string(), limits);
}

}  // namespace thimble
