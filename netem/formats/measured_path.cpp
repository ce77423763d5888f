#include "netem/formats/measured_path.hpp"

#include <iterator>

#include <fmt/format.h>

namespace thimble {
namespace {

// Nanoseconds as seconds, every digit and no more.
void append_seconds(std::string& text, std::int64_t ns) {
    const std::size_t start = text.size();
    fmt::format_to(std::back_inserter(text), "{}.{:09}", ns / 1'000'000'000, ns % 1'000'000'000);
    while (text.back() == '0') text.pop_back();
    if (text.back() == '.') text.pop_back();
    if (text.size() == start) text += '0';
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

}  // namespace thimble
