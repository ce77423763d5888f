#include "session/records/needle_file.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "common/csv/csv.hpp"
#include "common/decimal_text.hpp"
#include "common/text_file.hpp"
#include "netem/formats/text_lines.hpp"

namespace thimble {

namespace {

constexpr std::string_view kTime = "time_s";
constexpr std::string_view kPosition = "position_needle_m";

class Reader {
  public:
    Reader(std::string_view text, std::string_view name, const NeedleLimits& limits)
        : text_(plain_table(std::string(text), name)), lines_(text_, name), name_(name), limits_(limits) {}

    NeedlePath read() {
        read_header();
        NeedlePath path;
        std::string_view line;
        while (next_line(line)) append(read_sample(line), path.samples);
        if (path.samples.empty()) fail("no sample follows the header");
        return path;
    }

  private:
    [[noreturn]] void fail(std::string_view why) const { lines_.fail(why); }

    // Comments are passed over. Empty lines are only where the file ends.
    bool next_line(std::string_view& line) {
        for (std::size_t empty_line = 0; lines_.next();) {
            line = trimmed(lines_.line());
            if (line.empty()) {
                if (empty_line == 0) empty_line = lines_.number();
                continue;
            }
            if (empty_line > 0)
                fail_at_line(name_, empty_line,
                             "empty line inside the recording: fill the gap or remove the line");
            if (line.front() != '#') return true;
        }
        return false;
    }

    void read_header() {
        std::string_view header;
        if (!next_line(header)) {
            const auto why =
                fmt::format("the file is empty; it must begin with the header {},{}", kTime, kPosition);
            fail_at_line(name_, 1, why);
        }
        const auto names = fields_of(header);
        columns_ = names.size();
        time_column_ = find_column(names, kTime);
        position_column_ = find_column(names, kPosition);
    }

    std::size_t find_column(const std::vector<std::string_view>& names, std::string_view name) const {
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end())
            fail(fmt::format("the header has no column {}; it must name {} and {}", name, kTime, kPosition));
        if (std::find(found + 1, names.end(), name) != names.end())
            fail(fmt::format("the header names {} twice: remove one of the two columns", name));
        return static_cast<std::size_t>(found - names.begin());
    }

    NeedlePath::Sample read_sample(std::string_view line) const {
        const auto fields = fields_of(line);
        if (fields.size() != columns_)
            fail(fmt::format("has {} fields, the header {}", fields.size(), columns_));
        return {number(fields[time_column_], kTime), number(fields[position_column_], kPosition),
                lines_.number()};
    }

    double number(std::string_view field, std::string_view column) const {
        if (field.empty()) fail(fmt::format("{} is empty: fill the gap or remove the line", column));
        const bool plus = field.front() == '+' && !field.starts_with("+-");
        const auto value = parse_number(field.substr(plus ? 1 : 0));
        if (!value) fail(fmt::format("{} is '{}', which is not a finite number", column, field));
        return *value;
    }

    void append(const NeedlePath::Sample& sample, std::vector<NeedlePath::Sample>& samples) const {
        if (std::abs(sample.position_m) > limits_.farthest_m) {
            fail(fmt::format(
                "the needle is at {} m, more than {} m away: are these millimetres? Positions are in m",
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
            fail(fmt::format(
                "the needle would have moved {} m in {} s since line {}, at {:.4g} m/s, and {} m/s is "
                "the fastest that is believed: are these millimetres or milliseconds? Positions are "
                "in m, times in s",
                sample.position_m - before.position_m, elapsed_s, before.line,
                std::abs(sample.position_m - before.position_m) / elapsed_s, limits_.fastest_m_per_s));
        }
    }

    std::string text_;
    LineReader lines_;
    std::string_view name_;
    const NeedleLimits& limits_;
    std::size_t columns_ = 0, time_column_ = 0, position_column_ = 0;
};

}  // namespace

NeedlePath parse_needle_path(std::string_view text, std::string_view name, const NeedleLimits& limits) {
    return Reader(text, name, limits).read();
}

NeedlePath read_needle_path(const std::filesystem::path& file, const NeedleLimits& limits) {
    return parse_needle_path(read_whole_file(file), file.string(), limits);
}

}  // namespace thimble
