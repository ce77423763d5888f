#include "netem/formats/packet_trace_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "common/error.hpp"
#include "netem/formats/text_lines.hpp"

namespace thimble {
namespace {

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
    PathParser(std::string_view text, std::string_view name) : lines_(text, name), name_(name) {}

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
                    fmt::format("unknown column '{}': a trace has time_s or packet, delay_s, loss, "
                                "rate_bits_per_s",
                                field.substr(0, 40)));
            }
            if (has(known->quantity)) lines_.fail(fmt::format("column '{}' is there twice", field));
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
            lines_.fail(fmt::format("more than {} lines; split the trace", kMostPackets));
        }
        const std::vector<std::string_view> fields = fields_of(lines_.line());
        if (fields.size() != columns_.size()) {
            lines_.fail(fmt::format("has {} fields, the header {}", fields.size(), columns_.size()));
        }
        MeasuredPacket packet;
        for (std::size_t i = 0; i < fields.size(); ++i) read_field(fields[i], columns_[i], packet);
        check(packet);
        path_.packets.push_back(packet);
    }

    double number_in(std::string_view field, const ColumnName& column, double most) const {
        const auto value = parse_number(field);
        if (!value)
            lines_.fail(fmt::format("{}: '{}' is no finite number", column.name, field.substr(0, 40)));
        if (!(*value >= 0 && *value * column.scale <= most)) {
            lines_.fail(
                fmt::format("{}: {} must lie between 0 and {}", column.name, *value, most / column.scale));
        }
        return *value * column.scale;
    }

    void read_field(std::string_view field, const ColumnName& column, MeasuredPacket& packet) const {
        switch (column.quantity) {
            case Quantity::kTime:
                packet.at = std::llround(number_in(field, column, static_cast<double>(kLongestPath.count())));
                return;
            case Quantity::kPacket: {
                const auto number = parse_integer(field);
                if (!number || *number < 0) lines_.fail("packet: must be a whole number from 0");
                packet.at = *number;
                return;
            }
            case Quantity::kDelay:
                if (field.empty()) return;
                packet.delay = Duration{
                    std::llround(number_in(field, column, static_cast<double>(kLongestPathDelay.count())))};
                return;
            case Quantity::kLoss:
                packet.loss = number_in(field, column, 1);
                return;
            case Quantity::kRate:
                packet.bits_per_s = number_in(field, column, 1e12);
                if (!(packet.bits_per_s > 0)) {
                    lines_.fail(
                        "rate: must be above 0; a link that sends nothing has an outage, or loses all");
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

    LineReader lines_;
    std::string_view name_;
    std::vector<ColumnName> columns_;
    MeasuredPath path_;
};

// The delay that a lost packet would have had: that of the packet before it, or of the first received one.
Duration first_delay(const MeasuredPath& path) {
    for (const MeasuredPacket& packet : path.packets) {
        if (packet.delay) return *packet.delay;
    }
    return {};
}

}  // namespace

MeasuredPath parse_path(std::string_view text, std::string_view name) {
    return PathParser(text, name).parse();
}

PacketTrace to_trace(const MeasuredPath& path, const TraceChoice& choice, std::string_view name) {
    const TraceBy by = choice.by.value_or(path.by_packet ? TraceBy::kPacket : TraceBy::kTime);
    if (by == TraceBy::kTime && path.by_packet) {
        throw Error(ExitCode::kData,
                    fmt::format("{}: is to be replayed by time, but has packet numbers", name));
    }
    std::vector<TraceRow> rows;
    rows.reserve(path.packets.size());
    Duration delay = first_delay(path);
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

MeasuredPath to_path(const PacketTrace& trace) {
    MeasuredPath path;
    path.by_packet = trace.layout().by == TraceBy::kPacket;
    path.has_delay = trace.layout().has_delay;
    path.has_loss = trace.layout().has_loss;
    path.has_rate = trace.layout().has_rate;
    for (const TraceRow& row : trace.rows()) {
        path.packets.push_back({row.at, path.has_delay ? std::optional<Duration>(row.delay) : std::nullopt,
                                row.loss, row.bits_per_s});
    }
    return path;
}

}  // namespace thimble
