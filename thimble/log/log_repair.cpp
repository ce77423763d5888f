#include "thimble/log/log_repair.hpp"

#include <map>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/log/log_file.hpp"
#include "common/version.hpp"

namespace thimble {
namespace {

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
