// A small MCAP file in memory, and everything that a file says.
#pragma once

#include <string>
#include <vector>

#include "common/log/mcap_reader.hpp"
#include "common/log/mcap_writer.hpp"

namespace thimble {

struct MemorySink final : McapSink {
    std::vector<std::uint8_t> bytes;
    std::size_t room = SIZE_MAX;
    void write(Bytes more) override;
};

// The findings of a scan as text: one line for each thing, in order.
struct SaidByLog final : McapVisitor {
    std::vector<std::string> lines, messages;
    void library(std::string_view name) override { lines.emplace_back(name); }
    void schema(const McapSchema& s) override;
    void channel(const McapChannel& c) override;
    void message(const McapMessage& m) override;
    void metadata(const McapMetadata& m) override;
    void attachment(const McapAttachment& a) override;
};

Bytes letters(std::string_view text);
// Two schemas' worth of channels, two chunks, an attachment, metadata; the messages are "message 0" to "message 5".
std::vector<std::uint8_t> small_log();

}  // namespace thimble
