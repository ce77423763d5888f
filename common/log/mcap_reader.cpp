#include "common/log/mcap_reader.hpp"

#include <algorithm>
#include <unordered_set>
#include <utility>

#include <fmt/format.h>

#include "common/log/mcap_bytes.hpp"

namespace thimble {
namespace {

constexpr std::size_t kMostFlaws = 20;

struct McapRecord {
    std::uint8_t opcode = 0;
    Bytes content;
    std::size_t size = 0;  // with operation and length
    bool whole = false;
    bool is(McapOpcode other) const { return opcode == static_cast<std::uint8_t>(other); }
};

// The first of `bytes`; of one that is cut off, what is there of it.
McapRecord first_record(Bytes bytes) {
    McapRecord record;
    McapInput in(bytes);
    record.opcode = in.u8();
    const std::uint64_t length = in.u64();
    if (in.failed()) return record;
    record.whole = record.opcode != 0 && length <= in.left();
    record.content = record.whole ? in.bytes(length) : in.rest();
    record.size = kMcapPrefixBytes + record.content.size();
    return record;
}

class McapScanner {
  public:
    McapScanner(Bytes file, McapVisitor& visitor) : file_(file), visitor_(visitor) {}

    McapScan scan() {
        if (!begins_with_magic(file_)) return scan_;
        at_ = kMcapMagic.size();
        while (at_ < file_.size() && read_record()) {
        }
        scan_.whole_bytes = at_;
        if (scan_.begins && footer_) end();
        return std::move(scan_);
    }

  private:
    static bool begins_with_magic(Bytes bytes) {
        return bytes.size() >= kMcapMagic.size() &&
               std::equal(kMcapMagic.begin(), kMcapMagic.end(), bytes.begin());
    }

    void flaw(std::string words) {
        if (scan_.flaws.size() < kMostFlaws) scan_.flaws.push_back(fmt::format("at byte {}: {}", at_, words));
    }

    void damage(std::string_view what) {
        ++scan_.damaged;
        flaw(fmt::format("the CRC of {} is wrong, so it is skipped", what));
    }

    // False where the file ends for us.
    bool read_record() {
        const McapRecord record = first_record(file_.subspan(at_));
        if (!scan_.begins && !(record.whole && record.is(McapOpcode::kHeader))) return false;
        if (!record.whole) {
            if (record.is(McapOpcode::kChunk)) recover_chunk(record.content);
            return false;
        }
        read_content(record);
        at_ += record.size;
        return !footer_;
    }

    void read_content(const McapRecord& record) {
        switch (static_cast<McapOpcode>(record.opcode)) {
            case McapOpcode::kHeader:
                return read_header(record.content);
            case McapOpcode::kChunk:
                return read_chunk(record.content);
            case McapOpcode::kMetadata:
                return read_metadata(record.content);
            case McapOpcode::kAttachment:
                return read_attachment(record.content);
            case McapOpcode::kDataEnd:
                return read_data_end(record.content);
            case McapOpcode::kFooter:
                return read_footer(record.content);
            default:
                if (!summary_) read_in_chunk(record);
        }
    }

    void read_header(Bytes content) {
        McapInput in(content);
        in.text();
        const std::string_view library = in.text();
        if (in.failed()) return flaw("the header is too short");
        if (!std::exchange(scan_.begins, true)) visitor_.library(library);
    }

    // Records that may stand in a chunk, or outside of one. Others are skipped.
    bool read_in_chunk(const McapRecord& record) {
        if (record.is(McapOpcode::kMessage)) return read_message(record.content);
        if (record.is(McapOpcode::kChannel)) return read_channel(record.content);
        if (record.is(McapOpcode::kSchema)) return read_schema(record.content);
        return true;
    }

    bool read_schema(Bytes content) {
        McapInput in(content);
        McapSchema schema;
        schema.id = in.u16();
        schema.name = in.text();
        schema.encoding = in.text();
        const Bytes data = in.bytes(in.u32());
        if (in.failed() || schema.id == 0) return refuse("a schema is too short or has no number");
        schema.data.assign(data.begin(), data.end());
        visitor_.schema(schema);
        return true;
    }

    bool read_channel(Bytes content) {
        McapInput in(content);
        McapChannel channel;
        channel.id = in.u16();
        channel.schema = in.u16();
        channel.topic = in.text();
        channel.encoding = in.text();
        channel.metadata = in.map();
        if (in.failed()) return refuse("a channel is too short");
        if (!channels_.insert(channel.id).second) return true;
        visitor_.channel(channel);
        return true;
    }

    bool read_message(Bytes content) {
        McapInput in(content);
        McapMessage message;
        message.channel = in.u16();
        message.sequence = in.u32();
        message.log_time_ns = in.u64();
        message.publish_time_ns = in.u64();
        message.data = in.rest();
        if (in.failed()) return refuse("a message is too short");
        if (!channels_.contains(message.channel))
            return refuse("a message is on a channel that was not declared");
        ++scan_.messages;
        visitor_.message(message);
        return true;
    }

    bool refuse(std::string words) {
        flaw(std::move(words));
        return false;
    }

    void read_metadata(Bytes content) {
        McapInput in(content);
        McapMetadata metadata;
        metadata.name = in.text();
        metadata.pairs = in.map();
        if (in.failed()) return flaw("a metadata record is too short");
        visitor_.metadata(metadata);
    }

    void read_attachment(Bytes content) {
        McapInput in(content);
        McapAttachment attachment;
        attachment.log_time_ns = in.u64();
        in.u64();
        attachment.name = in.text();
        attachment.media_type = in.text();
        attachment.data = in.bytes(in.u64());
        const std::uint32_t crc = in.u32();
        if (in.failed()) return flaw("an attachment is too short");
        const std::size_t before = content.size() - in.left() - sizeof crc;
        if (crc != 0 && mcap_crc(0, content.first(before)) != crc) return damage("an attachment");
        visitor_.attachment(attachment);
    }

    struct ChunkHead {
        std::uint64_t size = 0, packed_size = 0;
        std::uint32_t crc = 0;
        bool readable = false;
    };
    ChunkHead read_chunk_head(McapInput& in) {
        ChunkHead head;
        in.u64();
        in.u64();
        head.size = in.u64();
        head.crc = in.u32();
        const std::string_view compression = in.text();
        head.packed_size = in.u64();
        if (in.failed()) return head;
        head.readable = compression.empty();
        if (!head.readable)
            flaw(fmt::format("a chunk is compressed with '{}', which Thimble does not read", compression));
        return head;
    }

    void read_chunk(Bytes content) {
        ++scan_.chunks;
        McapInput in(content);
        const ChunkHead head = read_chunk_head(in);
        const Bytes records = in.bytes(head.packed_size);
        if (in.failed()) return flaw("a chunk is too short");
        if (!head.readable) return;
        if (head.crc != 0 && mcap_crc(0, records) != head.crc) return damage("a chunk");
        if (!read_records(records)) flaw("a chunk holds unreadable records");
    }

    // Of a chunk whose end is not there. No CRC speaks for it; its records were written in one piece, from the front.
    void recover_chunk(Bytes content) {
        McapInput in(content);
        if (!read_chunk_head(in).readable) return;
        const std::uint64_t before = scan_.messages;
        read_records(in.rest());
        scan_.recovered = scan_.messages - before;
    }

    // False if they do not end where the chunk does.
    bool read_records(Bytes records) {
        while (!records.empty()) {
            const McapRecord record = first_record(records);
            if (!record.whole || !read_in_chunk(record)) return false;
            records = records.subspan(record.size);
        }
        return true;
    }

    void read_data_end(Bytes content) {
        McapInput in(content);
        const std::uint32_t crc = in.u32();
        if (crc != 0 && mcap_crc(0, file_.first(at_)) != crc) damage("the data section");
        summary_ = at_ + kMcapPrefixBytes + content.size();
    }

    void read_footer(Bytes content) {
        McapInput in(content);
        const std::uint64_t start = in.u64();
        in.u64();
        const std::uint32_t crc = in.u32();
        if (in.failed()) return flaw("the footer is too short");
        footer_ = true;
        if (start == 0 || crc == 0) return;
        const std::size_t end = at_ + kMcapPrefixBytes + 2 * sizeof(std::uint64_t);
        if (start > end || mcap_crc(0, file_.subspan(start, end - start)) != crc) damage("the summary");
    }

    void end() {
        const Bytes last = file_.subspan(scan_.whole_bytes);
        scan_.finished = last.size() == kMcapMagic.size() && begins_with_magic(last);
    }

    Bytes file_;
    McapVisitor& visitor_;
    McapScan scan_;
    std::size_t at_ = 0;
    std::size_t summary_ = 0;  // where it begins; 0: not reached
    bool footer_ = false;
    std::unordered_set<std::uint16_t> channels_;
};

}  // namespace

McapScan scan_mcap(Bytes file, McapVisitor& visitor) { return McapScanner(file, visitor).scan(); }

}  // namespace thimble
