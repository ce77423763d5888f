#include "netem/formats/trace_files.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "common/csv/csv.hpp"
#include "common/decimal_text.hpp"
#include "common/error.hpp"
#include "netem/formats/text_lines.hpp"

namespace thimble {
namespace {

constexpr std::int64_t kLastPacket = std::int64_t{1} << 53;  // so far a double counts, too
constexpr std::size_t kMostDeliveries = 50'000'000;          // ten minutes at 1 Gbit/s
constexpr std::int64_t kLongestDeliveries_ms = 86'400'000;   // a day

enum class Quantity : std::uint8_t { kTime, kPacket, kDelay, kLoss, kRate };

struct ColumnName {
    std::string_view name;
    Quantity quantity;
    double scale;  // to nanoseconds, packets, 1, bit/s
};

constexpr std::array<ColumnName, 13> kNames{{{"time_s", Quantity::kTime, 1e9},
                                             {"t_s", Quantity::kTime, 1e9},
                                             {"t_ms", Quantity::kTime, 1e6},
                                             {"t_us", Quantity::kTime, 1e3},
                                             {"t_ns", Quantity::kTime, 1},
                                             {"packet", Quantity::kPacket, 1},
                                             {"delay_s", Quantity::kDelay, 1e9},
                                             {"delay_ms", Quantity::kDelay, 1e6},
                                             {"delay_us", Quantity::kDelay, 1e3},
                                             {"delay_ns", Quantity::kDelay, 1},
                                             {"loss", Quantity::kLoss, 1},
                                             {"rate_bits_per_s", Quantity::kRate, 1},
                                             {"rate_kbps", Quantity::kRate, 1e3}}};

class PathParser {
  public:
    PathParser(std::string_view text, std::string_view name)
        : text_(plain_table(std::string(text), name)), lines_(text_, name), name_(name) {}

    MeasuredPath parse() {
        if (!next_line())
            fail_at_line(name_, 1, "is empty: a trace begins with a header such as time_s,delay_s,loss");
        read_header();
        while (next_line()) read_packet();
        if (path_.packets.empty()) lines_.fail("there is a header, but no line after it");
        return std::move(path_);
    }

  private:
    bool next_line() {
        while (lines_.next()) {
            const std::string_view line = trimmed(lines_.line());
            if (!line.empty() && line.front() != '#') return true;
            if (!line.empty() && columns_.empty()) path_.remarks.emplace_back(trimmed(line.substr(1)));
        }
        return false;
    }

    bool has(Quantity quantity) const {
        return std::any_of(columns_.begin(), columns_.end(),
                           [quantity](const ColumnName& c) { return c.quantity == quantity; });
    }

    void read_header() {
        for (const std::string_view field : fields_of(lines_.line())) {
            const auto known = std::find_if(kNames.begin(), kNames.end(),
                                            [field](const ColumnName& c) { return c.name == field; });
            if (known == kNames.end()) {
                lines_.fail(
                    "unknown column '{}': a trace has time_s or packet, delay_s, loss, rate_bits_per_s",
                    field.substr(0, 40));
            }
            if (has(known->quantity)) lines_.fail("column '{}' appears twice", field);
            columns_.push_back(*known);
        }
        if (has(Quantity::kTime) && has(Quantity::kPacket)) lines_.fail("has both times and packet numbers");
        if (!has(Quantity::kTime) && !has(Quantity::kPacket)) lines_.fail("needs a column time_s or packet");
        path_.by_packet = has(Quantity::kPacket);
        path_.has_delay = has(Quantity::kDelay);
        path_.has_loss = has(Quantity::kLoss);
        path_.has_rate = has(Quantity::kRate);
        if (!path_.has_delay && !path_.has_loss && !path_.has_rate) {
            lines_.fail("has neither delay_s nor loss nor rate_bits_per_s");
        }
    }

    void read_packet() {
        if (path_.packets.size() == kMostPackets) {
            lines_.fail("more than {} lines; split the trace", kMostPackets);
        }
        const std::vector<std::string_view> fields = fields_of(lines_.line());
        if (fields.size() != columns_.size()) {
            lines_.fail("has {} fields, the header {}", fields.size(), columns_.size());
        }
        MeasuredPacket packet;
        for (std::size_t i = 0; i < fields.size(); ++i) read_field(fields[i], columns_[i], packet);
        check(packet);
        path_.packets.push_back(packet);
    }

    // Up to `most` after scaling.
    double number_in(std::string_view field, const ColumnName& column, double most) const {
        const auto value = parse_number(field);
        if (!value) lines_.fail("{}: '{}' is not a finite number", column.name, field.substr(0, 40));
        if (!(*value >= 0 && *value * column.scale <= most)) {
            lines_.fail("{}: {} must lie between 0 and {}", column.name, *value, most / column.scale);
        }
        return *value * column.scale;
    }

    std::int64_t nanoseconds_in(std::string_view field, const ColumnName& column, Duration most) const {
        return std::llround(number_in(field, column, static_cast<double>(most.count())));
    }

    void read_field(std::string_view field, const ColumnName& column, MeasuredPacket& packet) const {
        switch (column.quantity) {
            case Quantity::kTime:
                packet.at = nanoseconds_in(field, column, kLongestPath);
                return;
            case Quantity::kPacket:
                packet.at = parse_whole<std::int64_t>(field).value_or(-1);
                if (packet.at < 0 || packet.at > kLastPacket)
                    lines_.fail("packet: must be a whole number from 0 to {}", kLastPacket);
                return;
            case Quantity::kDelay:
                if (!field.empty()) packet.delay = Duration{nanoseconds_in(field, column, kLongestPathDelay)};
                return;
            case Quantity::kLoss:
                packet.loss = number_in(field, column, 1);
                return;
            case Quantity::kRate:
                packet.bits_per_s = number_in(field, column, 1e12);
                if (packet.bits_per_s < 1) {
                    lines_.fail(
                        "rate: must be at least 1 bit/s; a link that sends nothing has an outage, or loses "
                        "all");
                }
                return;
        }
    }

    void check(const MeasuredPacket& packet) const {
        if (!path_.packets.empty() && packet.at <= path_.packets.back().at) {
            lines_.fail(path_.by_packet ? "packet numbers must rise" : "times must rise");
        }
        if (path_.has_delay && !packet.delay && packet.loss < 1) {
            lines_.fail("a delay may be empty only where loss is 1");
        }
    }

    std::string text_;
    LineReader lines_;
    std::string_view name_;
    std::vector<ColumnName> columns_;
    MeasuredPath path_;
};

// Appends nanoseconds as seconds with all digits and no trailing zeros.
void append_seconds(std::string& text, std::int64_t ns) {
    fmt::format_to(std::back_inserter(text), "{}.{:09}", ns / 1'000'000'000, ns % 1'000'000'000);
    while (text.back() == '0') text.pop_back();
    if (text.back() == '.') text.pop_back();
}

void append_packet(std::string& text, const MeasuredPacket& packet, const MeasuredPath& path) {
    if (path.by_packet) {
        text += std::to_string(packet.at);
    } else {
        append_seconds(text, packet.at);
    }
    if (path.has_delay) {
        text += ',';
        if (packet.delay) append_seconds(text, packet.delay->count());
    }
    if (path.has_loss) fmt::format_to(std::back_inserter(text), ",{}", packet.loss);
    if (path.has_rate) fmt::format_to(std::back_inserter(text), ",{}", packet.bits_per_s);
    text += '\n';
}

}  // namespace

MeasuredPath parse_path(std::string_view text, std::string_view name) {
    return PathParser(text, name).parse();
}

PacketTrace to_trace(const MeasuredPath& path, const TraceChoice& choice, std::string_view name) {
    const TraceBy by = choice.by.value_or(path.by_packet ? TraceBy::kPacket : TraceBy::kTime);
    if (by == TraceBy::kTime && path.by_packet) {
        throw Error(ExitCode::kData,
                    "{}: time replay needs a column time_s, but the trace has packet numbers", name);
    }
    std::vector<TraceRow> rows;
    rows.reserve(path.packets.size());
    // The delay that a lost packet would have had: that of the packet before it, or of the first received one.
    const auto received = std::find_if(path.packets.begin(), path.packets.end(),
                                       [](const MeasuredPacket& packet) { return packet.delay.has_value(); });
    Duration delay = received == path.packets.end() ? Duration{} : *received->delay;
    for (const MeasuredPacket& packet : path.packets) {
        delay = packet.delay.value_or(delay);
        const bool counted = by == TraceBy::kPacket && !path.by_packet;
        rows.push_back({counted ? static_cast<std::int64_t>(rows.size()) : packet.at, delay, packet.loss,
                        packet.bits_per_s});
    }
    return PacketTrace(std::move(rows),
                       {by, choice.between, choice.end, path.has_delay, path.has_loss, path.has_rate});
}

PacketTrace parse_packet_trace(std::string_view text, std::string_view name, const TraceChoice& choice) {
    return to_trace(parse_path(text, name), choice, name);
}

std::string print_path(const MeasuredPath& path) {
    std::string text;
    for (const std::string& remark : path.remarks) text += "# " + remark + '\n';
    text += path.by_packet ? "packet" : "time_s";
    if (path.has_delay) text += ",delay_s";
    if (path.has_loss) text += ",loss";
    if (path.has_rate) text += ",rate_bits_per_s";
    text += '\n';
    for (const MeasuredPacket& packet : path.packets) append_packet(text, packet, path);
    return text;
}

DeliveryTrace parse_delivery_trace(std::string_view text, std::string_view name) {
    std::vector<std::uint32_t> times_ms;
    LineReader lines(text, name);
    while (lines.next()) {
        const std::string_view line = trimmed(lines.line());
        const auto time = parse_whole<std::int64_t>(line);
        if (!time || *time < 0 || *time > kLongestDeliveries_ms) {
            lines.fail("'{}' is not a whole number of milliseconds from 0 to {}", line.substr(0, 40),
                       kLongestDeliveries_ms);
        }
        if (!times_ms.empty() && *time < times_ms.back()) lines.fail("times must not fall");
        if (times_ms.size() == kMostDeliveries) {
            lines.fail("more than {} lines; split the trace", kMostDeliveries);
        }
        times_ms.push_back(static_cast<std::uint32_t>(*time));
    }
    if (times_ms.empty()) fail_at_line(name, 1, "is empty: a trace has a time in milliseconds per line");
    if (times_ms.back() == 0) lines.fail("the last time must be above 0: it is the trace's length");
    return DeliveryTrace(std::move(times_ms));
}

}  // namespace thimble
