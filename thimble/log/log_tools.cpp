#include "thimble/log/log_tools.hpp"

#include <cstdlib>
#include <ctime>
#include <map>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/log/log_file.hpp"
#include "common/version.hpp"

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

constexpr std::size_t kRepairedChunkBytes = std::size_t{1} << 18;

// Numbers of schemas and channels are the writer's.
class CopyingVisitor final : public McapVisitor {
  public:
    explicit CopyingVisitor(McapWriter& writer) : writer_(writer) {}
    void schema(const McapSchema& s) override {
        if (!schemas_.contains(s.id)) schemas_[s.id] = writer_.add_schema(s.name, s.encoding, s.data);
    }
    void channel(const McapChannel& c) override {
        const auto schema = schemas_.find(c.schema);
        channels_[c.id] = writer_.add_channel(schema == schemas_.end() ? std::uint16_t{0} : schema->second,
                                              c.topic, c.encoding, c.metadata);
    }
    void message(const McapMessage& m) override {
        McapMessage copy = m;
        copy.channel = channels_.at(m.channel);
        writer_.add_message(copy);
        if (writer_.chunk_bytes() >= kRepairedChunkBytes) writer_.flush();
    }
    void metadata(const McapMetadata& m) override { writer_.add_metadata(m.name, m.pairs); }
    void attachment(const McapAttachment& a) override { writer_.add_attachment(a); }

  private:
    McapWriter& writer_;
    std::map<std::uint16_t, std::uint16_t> schemas_, channels_;
};

}  // namespace

std::string describe_end(const LoggedFile& file) {
    const McapScan& scan = file.scan();
    if (scan.finished) return "whole";
    const std::uint64_t behind = file.bytes().size() - scan.whole_bytes;
    std::string text = "its writer did not finish it";
    if (behind > 0) text += fmt::format(", {} bytes after the last whole record", behind);
    if (scan.recovered > 0) text += fmt::format(", {} messages from an unfinished chunk", scan.recovered);
    return text + "; repair it with thimble log repair";
}

std::string describe_log(const LoggedFile& file) {
    const double duration_s = 1e-9 * static_cast<double>(file.last_ns() - file.first_ns());
    std::string text = fmt::format("{}\n", file.path().string());
    const auto line = [&](std::string_view name, const std::string& value) {
        text += fmt::format("  {:<12}{}\n", name, value);
    };
    const std::string program = file.value("thimble", "program");
    const bool ours = !program.empty();  // else an export, or a stranger's file: it sent and received nothing
    line("written by", ours ? fmt::format("{} ({})", program, file.library()) : file.library());
    if (ours) line("begun", date_of(file));
    line("end", describe_end(file));
    line("size", fmt::format("{} bytes, {} chunks", file.bytes().size(), file.scan().chunks));
    line("messages",
         fmt::format("{} in {:.3f} s, {} lost by the log", file.scan().messages, duration_s, file.lost()));
    for (const auto& [id, topic] : file.topics()) {
        line(!ours        ? "  topic"
             : topic.sent ? "  sent"
                          : "  received",
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

McapScan copy_whole_records(Bytes file, McapWriter& to) {
    CopyingVisitor copying(to);
    return scan_mcap(file, copying);
}

RepairResult repair_log(const std::filesystem::path& from, const std::filesystem::path& to) {
    const LoggedFile old(from);  // which refuses what is no log before anything is written
    LogFile file(to);
    McapWriter writer(file, fmt::format("thimble {}, repaired", kVersion));
    RepairResult result;
    result.scan = copy_whole_records(old.bytes(), writer);
    result.bytes_cut = result.scan.finished ? 0 : old.bytes().size() - result.scan.whole_bytes;
    writer.add_metadata("repair", {{"bytes_cut", std::to_string(result.bytes_cut)},
                                   {"damaged_parts", std::to_string(result.scan.damaged)},
                                   {"messages_recovered", std::to_string(result.scan.recovered)}});
    writer.finish();
    file.sync();
    result.messages = writer.messages();
    return result;
}

}  // namespace thimble
