#include "common/log/mcap_writer.hpp"

#include <algorithm>
#include <cassert>

namespace thimble {

std::string_view value_of(const McapMap& pairs, std::string_view key) {
    const auto found =
        std::find_if(pairs.begin(), pairs.end(), [&](const auto& pair) { return pair.first == key; });
    return found == pairs.end() ? std::string_view{} : std::string_view(found->second);
}

McapWriter::McapWriter(McapSink& sink, std::string_view library, std::string_view profile) : sink_(sink) {
    out_.bytes(kMcapMagic);
    const std::size_t header = out_.open(McapOpcode::kHeader);
    out_.text(profile);
    out_.text(library);
    out_.close(header);
    hand_over();
}

void McapWriter::hand_over() {
    try {
        sink_.write(out_.view());
    } catch (...) {
        out_.clear();
        throw;
    }
    data_crc_ = mcap_crc(data_crc_, out_.view());
    offset_ += out_.size();
    out_.clear();
}

std::uint16_t McapWriter::add_schema(std::string_view name, std::string_view encoding, Bytes data) {
    const auto id = static_cast<std::uint16_t>(schemas_ + 1);
    const std::size_t record = out_.open(McapOpcode::kSchema);
    out_.u16(id);
    out_.text(name);
    out_.text(encoding);
    out_.u32(static_cast<std::uint32_t>(data.size()));
    out_.bytes(data);
    out_.close(record);
    copy_to_summary(schema_records_, record);
    hand_over();
    schemas_ = id;
    return id;
}

std::uint16_t McapWriter::add_channel(std::uint16_t schema, std::string_view topic, std::string_view encoding,
                                      const McapMap& metadata) {
    const auto id = static_cast<std::uint16_t>(counts_.size());
    const std::size_t record = out_.open(McapOpcode::kChannel);
    out_.u16(id);
    out_.u16(schema);
    out_.text(topic);
    out_.text(encoding);
    out_.map(metadata);
    out_.close(record);
    copy_to_summary(channel_records_, record);
    hand_over();
    counts_.push_back(0);
    chunk_index_.emplace_back();
    return id;
}

void McapWriter::copy_to_summary(McapOutput& summary, std::size_t record) const {
    summary.bytes(out_.view().subspan(record));
}

void McapWriter::add_metadata(std::string_view name, const McapMap& pairs) {
    const std::uint64_t at = offset_;
    const std::size_t record = out_.open(McapOpcode::kMetadata);
    out_.text(name);
    out_.map(pairs);
    out_.close(record);
    const std::uint64_t length = out_.size();
    hand_over();
    const std::size_t index = metadata_records_.open(McapOpcode::kMetadataIndex);
    metadata_records_.u64(at);
    metadata_records_.u64(length);
    metadata_records_.text(name);
    metadata_records_.close(index);
    ++metadata_;
}

void McapWriter::add_attachment(const McapAttachment& attachment) {
    const std::uint64_t at = offset_;
    const std::size_t record = out_.open(McapOpcode::kAttachment);
    out_.u64(attachment.log_time_ns);
    out_.u64(0);  // when it was made is not known
    out_.text(attachment.name);
    out_.text(attachment.media_type);
    out_.u64(attachment.data.size());
    out_.bytes(attachment.data);
    out_.u32(mcap_crc(0, out_.view().subspan(record + kMcapPrefixBytes)));
    out_.close(record);
    const std::uint64_t length = out_.size();
    hand_over();
    const std::size_t index = attachment_records_.open(McapOpcode::kAttachmentIndex);
    for (const std::uint64_t number : {at, length, attachment.log_time_ns, std::uint64_t{0},
                                       static_cast<std::uint64_t>(attachment.data.size())}) {
        attachment_records_.u64(number);
    }
    attachment_records_.text(attachment.name);
    attachment_records_.text(attachment.media_type);
    attachment_records_.close(index);
    ++attachments_;
}

void McapWriter::add_message(const McapMessage& message) {
    assert(message.channel < counts_.size());
    const bool first = chunk_messages_ == 0;
    chunk_start_ns_ = first ? message.log_time_ns : std::min(chunk_start_ns_, message.log_time_ns);
    chunk_end_ns_ = first ? message.log_time_ns : std::max(chunk_end_ns_, message.log_time_ns);
    chunk_index_[message.channel].push_back({message.log_time_ns, chunk_.size()});
    const std::size_t record = chunk_.open(McapOpcode::kMessage);
    chunk_.u16(message.channel);
    chunk_.u32(message.sequence);
    chunk_.u64(message.log_time_ns);
    chunk_.u64(message.publish_time_ns);
    chunk_.bytes(message.data);
    chunk_.close(record);
    ++chunk_messages_;
}

void McapWriter::flush() {
    if (chunk_messages_ == 0) return;
    const std::uint64_t chunk_at = offset_;
    write_chunk();
    const std::uint64_t chunk_length = out_.size();
    McapOutput index;
    const std::size_t record = index.open(McapOpcode::kChunkIndex);
    for (const std::uint64_t number : {chunk_start_ns_, chunk_end_ns_, chunk_at, chunk_length})
        index.u64(number);
    write_message_indexes(index);
    index.u64(out_.size() - chunk_length);
    index.text("");
    index.u64(chunk_.size());
    index.u64(chunk_.size());
    index.close(record);
    try {
        hand_over();
    } catch (...) {
        forgotten_ += chunk_messages_;
        forget_chunk();
        throw;
    }
    chunk_records_.bytes(index.view());
    if (chunk_records_.size() >= kLongIndexBytes && sink_.set_aside(chunk_records_.view()))
        chunk_records_.clear();
    count_chunk();
    forget_chunk();
}

// One per channel behind the chunk; where they stand goes to `index`.
void McapWriter::write_message_indexes(McapOutput& index) {
    const std::size_t list = index.open_list();
    for (std::size_t channel = 0; channel < chunk_index_.size(); ++channel) {
        if (chunk_index_[channel].empty()) continue;
        index.u16(static_cast<std::uint16_t>(channel));
        index.u64(offset_ + out_.size());
        const std::size_t record = out_.open(McapOpcode::kMessageIndex);
        out_.u16(static_cast<std::uint16_t>(channel));
        const std::size_t entries = out_.open_list();
        for (const IndexEntry& entry : chunk_index_[channel]) {
            out_.u64(entry.log_time_ns);
            out_.u64(entry.offset);
        }
        out_.close_list(entries);
        out_.close(record);
    }
    index.close_list(list);
}

void McapWriter::count_chunk() {
    start_ns_ = messages_ == 0 ? chunk_start_ns_ : std::min(start_ns_, chunk_start_ns_);
    end_ns_ = messages_ == 0 ? chunk_end_ns_ : std::max(end_ns_, chunk_end_ns_);
    messages_ += chunk_messages_;
    for (std::size_t channel = 0; channel < counts_.size(); ++channel)
        counts_[channel] += chunk_index_[channel].size();
    ++chunks_;
}

void McapWriter::write_chunk() {
    const std::size_t record = out_.open(McapOpcode::kChunk);
    out_.u64(chunk_start_ns_);
    out_.u64(chunk_end_ns_);
    out_.u64(chunk_.size());
    out_.u32(mcap_crc(0, chunk_.view()));
    out_.text("");
    out_.u64(chunk_.size());
    out_.bytes(chunk_.view());
    out_.close(record);
}

void McapWriter::forget_chunk() {
    chunk_.clear();
    chunk_messages_ = 0;
    for (auto& entries : chunk_index_) entries.clear();
}

void McapWriter::write_statistics(McapOutput& out) const {
    const std::size_t record = out.open(McapOpcode::kStatistics);
    out.u64(messages_);
    out.u16(schemas_);
    out.u32(static_cast<std::uint32_t>(counts_.size()));
    for (const std::uint32_t count : {attachments_, metadata_, chunks_}) out.u32(count);
    out.u64(start_ns_);
    out.u64(end_ns_);
    const std::size_t list = out.open_list();
    for (std::size_t channel = 0; channel < counts_.size(); ++channel) {
        out.u16(static_cast<std::uint16_t>(channel));
        out.u64(counts_[channel]);
    }
    out.close_list(list);
    out.close(record);
}

void McapWriter::hand_over_summary() {
    summary_crc_ = mcap_crc(summary_crc_, out_.view());
    hand_over();
}

// Of chunks, those that were set aside come first.
void McapWriter::write_group(McapOutput& offsets, McapOpcode opcode, const McapOutput& records) {
    const std::uint64_t start = offset_;
    if (opcode == McapOpcode::kChunkIndex) {
        sink_.give_back([this](Bytes bytes) {
            out_.bytes(bytes);
            hand_over_summary();
        });
    }
    out_.bytes(records.view());
    hand_over_summary();
    if (offset_ == start) return;
    const std::size_t record = offsets.open(McapOpcode::kSummaryOffset);
    offsets.u8(static_cast<std::uint8_t>(opcode));
    offsets.u64(start);
    offsets.u64(offset_ - start);
    offsets.close(record);
}

void McapWriter::finish() {
    flush();
    const std::size_t end = out_.open(McapOpcode::kDataEnd);
    out_.u32(data_crc_);
    out_.close(end);
    hand_over();
    const std::uint64_t summary_at = offset_;
    McapOutput statistics, offsets;
    write_statistics(statistics);
    write_group(offsets, McapOpcode::kSchema, schema_records_);
    write_group(offsets, McapOpcode::kChannel, channel_records_);
    write_group(offsets, McapOpcode::kStatistics, statistics);
    write_group(offsets, McapOpcode::kChunkIndex, chunk_records_);
    write_group(offsets, McapOpcode::kAttachmentIndex, attachment_records_);
    write_group(offsets, McapOpcode::kMetadataIndex, metadata_records_);
    const std::uint64_t offsets_at = offset_;
    out_.bytes(offsets.view());
    const std::size_t footer = out_.open(McapOpcode::kFooter);
    out_.u64(summary_at);
    out_.u64(offsets_at);
    out_.u32(0);
    out_.close(footer);
    const std::size_t crc_at = out_.size() - sizeof(std::uint32_t);
    out_.put_u32(crc_at, mcap_crc(summary_crc_, out_.view().first(crc_at)));
    out_.bytes(kMcapMagic);
    hand_over();
}

}  // namespace thimble
