#include "thimble/log/log_info.hpp"

#include <cstdlib>
#include <ctime>

#include <fmt/format.h>

namespace thimble {
namespace {

// Of the moment that the log was begun, in UTC.
std::string date_of(const LoggedFile& file) {
    const std::time_t seconds =
        std::strtoll(file.value("thimble", "realtime_ns").c_str(), nullptr, 10) / 1'000'000'000;
    std::tm broken_down{};
    char text[32] = "";
    if (seconds == 0 || gmtime_r(&seconds, &broken_down) == nullptr) return "unknown";
    std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S UTC", &broken_down);
    return text;
}

}  // namespace

std::string describe_end(const LoggedFile& file) {
    const McapScan& scan = file.scan();
    if (scan.finished) return "whole";
    const std::uint64_t behind = file.bytes().size() - scan.whole_bytes;
    std::string text = "its writer did not end it";
    if (behind > 0) text += fmt::format(", {} bytes behind the last whole record", behind);
    if (scan.recovered > 0) text += fmt::format(", {} messages out of an unfinished chunk", scan.recovered);
    return text + "; thimble log repair makes a whole file of it";
}

std::string describe_log(const LoggedFile& file) {
    const double duration_s = 1e-9 * static_cast<double>(file.last_ns() - file.first_ns());
    std::string text = fmt::format("{}\n", file.path().string());
    const auto line = [&](std::string_view name, const std::string& value) {
        text += fmt::format("  {:<12}{}\n", name, value);
    };
    line("written by", fmt::format("{} ({})", file.value("thimble", "program"), file.library()));
    line("begun", date_of(file));
    line("end", describe_end(file));
    line("size", fmt::format("{} bytes, {} chunks", file.bytes().size(), file.scan().chunks));
    line("messages",
         fmt::format("{} in {:.3f} s, {} lost by the log", file.scan().messages, duration_s, file.lost()));
    for (const auto& [id, topic] : file.topics()) {
        line(topic.sent ? "  sent" : "  received",
             fmt::format("{:<44}{:>9}{}", topic.topic, topic.messages,
                         duration_s > 0
                             ? fmt::format("  {:8.1f} Hz", static_cast<double>(topic.messages) / duration_s)
                             : ""));
    }
    for (const LogAttachment& a : file.attachments())
        line("attached", fmt::format("{} ({} bytes)", a.name, a.bytes));
    for (const std::string& flaw : file.scan().flaws) line("flaw", flaw);
    return text;
}

}  // namespace thimble
