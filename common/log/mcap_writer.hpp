// Writes MCAP from front to back: nothing is ever changed that has been written. Messages are gathered into a chunk, which
// flush() hands over with its index in one piece; finish() writes the index of all chunks.
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "common/log/mcap_bytes.hpp"

namespace thimble {

// Where the bytes go, whole records at a time. May throw Error: the writer then stands where it stood before.
class McapSink {
  public:
    virtual void write(Bytes bytes) = 0;
    // Keeps these bytes, after those kept before, until the file ends: so a long log's index needs no memory. False:
    // not kept, the writer holds them.
    virtual bool set_aside(Bytes /*bytes*/) { return false; }
    // All that was set aside, in the same portions and order.
    virtual void give_back(const std::function<void(Bytes)>& /*use*/) {}

  protected:
    ~McapSink() = default;
};

class McapWriter {
  public:
    // `sink` outlives the writer. Begins the file; `profile`: a set of rules that MCAP knows by name, such as "ros2".
    McapWriter(McapSink& sink, std::string_view library, std::string_view profile = {});

    // These return the new record's number in the file.
    std::uint16_t add_schema(std::string_view name, std::string_view encoding, Bytes data);
    std::uint16_t add_channel(std::uint16_t schema, std::string_view topic, std::string_view encoding,
                              const McapMap& metadata);
    void add_metadata(std::string_view name, const McapMap& pairs);
    void add_attachment(const McapAttachment& attachment);
    // Into the chunk; its channel has been added.
    void add_message(const McapMessage& message);

    // The chunk, if there is anything in it. If that fails, its messages are lost.
    void flush();
    // Index, statistics and end; nothing may be written afterwards.
    void finish();

    std::uint64_t bytes() const { return offset_; }  // handed over so far
    std::uint64_t messages() const { return messages_; }
    std::uint64_t forgotten() const {
        return forgotten_;
    }  // messages of chunks that could not be handed over
    std::size_t chunk_bytes() const { return chunk_.size(); }
    std::size_t index_bytes() const { return chunk_records_.size(); }  // held in memory

    // An index longer than this is set aside, where the sink does that.
    static constexpr std::size_t kLongIndexBytes = std::size_t{64} << 10U;

  private:
    struct IndexEntry {
        std::uint64_t log_time_ns, offset;
    };
    void hand_over();
    void copy_to_summary(McapOutput& summary, std::size_t record) const;
    void write_chunk();
    void write_message_indexes(McapOutput& index);
    void count_chunk();
    void write_statistics(McapOutput& out) const;
    void hand_over_summary();
    void write_group(McapOutput& offsets, McapOpcode opcode, const McapOutput& records);
    void forget_chunk();

    McapSink& sink_;
    McapOutput out_;    // the records that go next
    McapOutput chunk_;  // records of the open chunk
    std::uint64_t offset_ = 0;
    std::uint32_t data_crc_ = 0, summary_crc_ = 0;
    std::uint16_t schemas_ = 0;
    std::vector<std::vector<IndexEntry>> chunk_index_;  // by channel, of the open chunk
    std::uint64_t chunk_start_ns_ = 0, chunk_end_ns_ = 0;
    std::vector<std::uint64_t> counts_;  // messages by channel
    std::uint64_t messages_ = 0, chunk_messages_ = 0, forgotten_ = 0;
    std::uint64_t start_ns_ = 0, end_ns_ = 0;
    std::uint32_t chunks_ = 0, attachments_ = 0, metadata_ = 0;
    // As they will stand in the summary.
    McapOutput schema_records_, channel_records_, chunk_records_, attachment_records_, metadata_records_;
};

}  // namespace thimble
