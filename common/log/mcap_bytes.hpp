// The bytes of MCAP (https://mcap.dev/spec): little-endian numbers, texts and lists with their length before them, records of
// one byte of operation, eight bytes of length, and content.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/channel.hpp"

namespace thimble {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they stand");

inline constexpr std::array<std::uint8_t, 8> kMcapMagic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

enum class McapOpcode : std::uint8_t {
    kHeader = 0x01,
    kFooter,
    kSchema,
    kChannel,
    kMessage,
    kChunk,
    kMessageIndex,
    kChunkIndex,
    kAttachment,
    kAttachmentIndex,
    kStatistics,
    kMetadata,
    kMetadataIndex,
    kSummaryOffset,
    kDataEnd,
};
// Of a record: operation and length.
inline constexpr std::size_t kMcapPrefixBytes = 9;

// CRC-32 as in zlib, of what came before with these bytes behind it; 0 to begin with.
std::uint32_t mcap_crc(std::uint32_t before, Bytes bytes);

class McapOutput {
  public:
    void u8(std::uint8_t value) { bytes_.push_back(value); }
    void u16(std::uint16_t value) { number(value); }
    void u32(std::uint32_t value) { number(value); }
    void u64(std::uint64_t value) { number(value); }
    void bytes(Bytes more) {
        const std::size_t at = bytes_.size();
        bytes_.resize(at + more.size());
        std::copy(more.begin(), more.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(at));
    }
    void text(std::string_view text);
    void map(const std::vector<std::pair<std::string, std::string>>& pairs);

    // Between the two stands the content; returns where its record begins.
    std::size_t open(McapOpcode opcode);
    void close(std::size_t record);
    // Length in bytes, 32 bits, of what is written between the two.
    std::size_t open_list();
    void close_list(std::size_t list);
    // In the place of what stands there.
    void put_u32(std::size_t at, std::uint32_t value) {
        std::memcpy(bytes_.data() + at, &value, sizeof value);
    }

    std::size_t size() const { return bytes_.size(); }
    Bytes view() const { return bytes_; }
    void clear() { bytes_.clear(); }

  private:
    template <class Number>
    void number(Number value) {
        const std::size_t at = bytes_.size();
        bytes_.resize(at + sizeof value);
        std::memcpy(bytes_.data() + at, &value, sizeof value);
    }

    std::vector<std::uint8_t> bytes_;
};

// Reads from the front. Past the end all values are zero or empty and failed() is true.
class McapInput {
  public:
    explicit McapInput(Bytes bytes) : bytes_(bytes) {}

    std::uint8_t u8() { return number<std::uint8_t>(); }
    std::uint16_t u16() { return number<std::uint16_t>(); }
    std::uint32_t u32() { return number<std::uint32_t>(); }
    std::uint64_t u64() { return number<std::uint64_t>(); }
    Bytes bytes(std::uint64_t size);
    std::string_view text();
    std::vector<std::pair<std::string, std::string>> map();
    Bytes rest() { return bytes(bytes_.size()); }

    std::size_t left() const { return bytes_.size(); }
    bool failed() const { return failed_; }

  private:
    template <class Number>
    Number number() {
        Number value{};
        const Bytes from = bytes(sizeof value);
        if (!from.empty()) std::memcpy(&value, from.data(), sizeof value);
        return value;
    }

    Bytes bytes_;
    bool failed_ = false;
};

// The records of an MCAP file, as plain values (https://mcap.dev/spec). Views end with the bytes they were read from.
using McapMap = std::vector<std::pair<std::string, std::string>>;

struct McapSchema {
    std::uint16_t id = 0;  // 0: none
    std::string name, encoding;
    std::vector<std::uint8_t> data;
};

struct McapChannel {
    std::uint16_t id = 0;
    std::uint16_t schema = 0;
    std::string topic, encoding;
    McapMap metadata;
};

struct McapMessage {
    std::uint16_t channel = 0;
    std::uint32_t sequence = 0;
    std::uint64_t log_time_ns = 0, publish_time_ns = 0;
    Bytes data;
};

struct McapAttachment {
    std::uint64_t log_time_ns = 0;
    std::string_view name, media_type;
    Bytes data;
};

struct McapMetadata {
    std::string_view name;
    McapMap pairs;
};

// The value of a key; empty if there is none.
std::string_view value_of(const McapMap& pairs, std::string_view key);

}  // namespace thimble
