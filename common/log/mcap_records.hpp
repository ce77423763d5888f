// The records of an MCAP file, as plain values (https://mcap.dev/spec). Views end with the bytes they were read from.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/channel.hpp"

namespace thimble {

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
