#include "common/log/mcap_bytes.hpp"

#include <zlib.h>

namespace thimble {

std::uint32_t mcap_crc(std::uint32_t before, Bytes bytes) {
    if (bytes.empty()) return before;  // which zlib takes for the beginning
    return static_cast<std::uint32_t>(crc32_z(before, bytes.data(), bytes.size()));
}

void McapOutput::text(std::string_view text) {
    u32(static_cast<std::uint32_t>(text.size()));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
}

void McapOutput::map(const std::vector<std::pair<std::string, std::string>>& pairs) {
    const std::size_t list = open_list();
    for (const auto& [key, value] : pairs) {
        text(key);
        text(value);
    }
    close_list(list);
}

std::size_t McapOutput::open(McapOpcode opcode) {
    const std::size_t record = bytes_.size();
    u8(static_cast<std::uint8_t>(opcode));
    u64(0);
    return record;
}

void McapOutput::close(std::size_t record) {
    const std::uint64_t size = bytes_.size() - record - kMcapPrefixBytes;
    std::memcpy(bytes_.data() + record + 1, &size, sizeof size);
}

std::size_t McapOutput::open_list() {
    const std::size_t list = bytes_.size();
    u32(0);
    return list;
}

void McapOutput::close_list(std::size_t list) {
    put_u32(list, static_cast<std::uint32_t>(bytes_.size() - list - sizeof(std::uint32_t)));
}

Bytes McapInput::bytes(std::uint64_t size) {
    if (size > bytes_.size()) {
        failed_ = true;
        bytes_ = {};
        return {};
    }
    const Bytes front = bytes_.first(static_cast<std::size_t>(size));
    bytes_ = bytes_.subspan(static_cast<std::size_t>(size));
    return front;
}

std::string_view McapInput::text() {
    const Bytes letters = bytes(u32());
    return {static_cast<const char*>(static_cast<const void*>(letters.data())), letters.size()};
}

std::vector<std::pair<std::string, std::string>> McapInput::map() {
    McapInput list(bytes(u32()));
    std::vector<std::pair<std::string, std::string>> pairs;
    while (!failed_ && list.left() > 0 && !list.failed()) {
        const std::string_view key = list.text();
        const std::string_view value = list.text();
        if (!list.failed()) pairs.emplace_back(key, value);
    }
    failed_ = failed_ || list.failed();
    return pairs;
}

}  // namespace thimble
