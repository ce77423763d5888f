#include "tests/kernel/path_sample.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "common/text_file.hpp"
#include "netem/formats/text_lines.hpp"

namespace thimble {
namespace {

constexpr std::size_t kBatches = 20;

std::int64_t read_count(const LineReader& lines, std::string_view field, std::string_view name) {
    const auto value = parse_integer(field);
    if (!value || *value < 0)
        lines.fail(fmt::format("'{}' is no {}; a whole number from 0 belongs here", field, name));
    return *value;
}

std::vector<std::string_view> read_fields(const LineReader& lines, std::size_t count) {
    std::vector<std::string_view> fields = fields_of(lines.line());
    if (fields.size() != count) lines.fail(fmt::format("{} fields instead of {}", fields.size(), count));
    return fields;
}

PathPacket read_packet(const LineReader& lines) {
    if (lines.line().empty()) return {};
    const auto fields = read_fields(lines, 2);
    return {true, read_count(lines, fields[1], "overtaken (0 or 1)") != 0,
            Duration{read_count(lines, fields[0], "delay_ns")}};
}

double share_error(const std::vector<PathPacket>& packets, double share) {
    double squares = 0;
    const std::size_t length = packets.size() / kBatches;
    if (length == 0) return 0;
    for (std::size_t batch = 0; batch < kBatches; ++batch) {
        const auto begin = packets.begin() + static_cast<std::ptrdiff_t>(batch * length);
        const auto count = std::count_if(begin, begin + static_cast<std::ptrdiff_t>(length),
                                         [](const PathPacket& packet) { return packet.overtaken; });
        const double off = static_cast<double>(count) / static_cast<double>(length) - share;
        squares += off * off;
    }
    return std::sqrt(squares / static_cast<double>(kBatches * (kBatches - 1)));
}

}  // namespace

void write_path_sample(const PathSample& sample, const std::string& file) {
    std::string text = fmt::format("{},{},{}\n", sample.copies, sample.strangers, sample.untrusted);
    for (const PathPacket& packet : sample.packets) {
        if (packet.arrived) {
            fmt::format_to(std::back_inserter(text), "{},{:d}", packet.delay.count(), packet.overtaken);
        }
        text += '\n';
    }
    write_text_file(file, text);
}

PathSample read_path_sample(const std::string& file) {
    const std::string text = read_whole_file(file);
    LineReader lines(text, file);
    if (!lines.next()) fail_at_line(file, 1, "empty; kernel_path_peer measure writes such files");
    const auto counts = read_fields(lines, 3);
    PathSample sample;
    sample.copies = static_cast<std::uint64_t>(read_count(lines, counts[0], "copies"));
    sample.strangers = static_cast<std::uint64_t>(read_count(lines, counts[1], "strangers"));
    sample.untrusted = static_cast<std::uint64_t>(read_count(lines, counts[2], "untrusted"));
    while (lines.next()) sample.packets.push_back(read_packet(lines));
    return sample;
}

double PathSummary::quantile_s(double q) const {
    if (sorted_s.empty()) return 0;
    return sorted_s[static_cast<std::size_t>(q * static_cast<double>(sorted_s.size() - 1))];
}

double PathSummary::mean_error_s() const {
    return sorted_s.empty() ? 0 : deviation_s / std::sqrt(static_cast<double>(sorted_s.size()));
}

PathSummary summarise(const PathSample& sample) {
    PathSummary summary;
    summary.sent = sample.packets.size();
    summary.copies = sample.copies;
    summary.strangers = sample.strangers;
    summary.untrusted = sample.untrusted;
    std::size_t overtaken = 0;
    double sum_s = 0, squares_s2 = 0;
    for (const PathPacket& packet : sample.packets) {
        if (packet.arrived) summary.sorted_s.push_back(to_seconds(packet.delay));
        overtaken += packet.overtaken ? 1U : 0U;
    }
    std::sort(summary.sorted_s.begin(), summary.sorted_s.end());
    const auto arrived = static_cast<double>(summary.sorted_s.size());
    summary.lost = summary.sent - summary.sorted_s.size();
    if (summary.sorted_s.empty()) return summary;
    for (const double delay_s : summary.sorted_s) sum_s += delay_s;
    summary.mean_s = sum_s / arrived;
    for (const double delay_s : summary.sorted_s) {
        squares_s2 += (delay_s - summary.mean_s) * (delay_s - summary.mean_s);
    }
    summary.deviation_s = std::sqrt(squares_s2 / std::max(1.0, arrived - 1));
    summary.overtaken = static_cast<double>(overtaken) / static_cast<double>(summary.sent);
    summary.overtaken_error = share_error(sample.packets, summary.overtaken);
    return summary;
}

}  // namespace thimble
