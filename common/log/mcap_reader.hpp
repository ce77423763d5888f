// Reads MCAP from front to back, without its index: so a file that was cut off, by a kill, a power cut or a full disk, gives
// everything up to its last whole record, also out of a chunk that was not finished.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/log/mcap_bytes.hpp"

namespace thimble {

// Receives the parts of a file as it is read. Everything ends with the call.
class McapVisitor {
  public:
    virtual ~McapVisitor() = default;
    virtual void library(std::string_view /*name*/) {}
    virtual void schema(const McapSchema& /*schema*/) {}
    virtual void channel(const McapChannel& /*channel*/) {}
    // Its channel has been seen.
    virtual void message(const McapMessage& /*message*/) {}
    virtual void metadata(const McapMetadata& /*metadata*/) {}
    virtual void attachment(const McapAttachment& /*attachment*/) {}
};

struct McapScan {
    bool begins = false;            // magic and header are there
    bool finished = false;          // so are footer and magic at the end
    std::uint64_t whole_bytes = 0;  // to the end of the last whole record
    std::uint64_t messages = 0, chunks = 0;
    std::uint64_t recovered = 0;  // of the messages: out of a chunk that was not finished
    std::uint64_t damaged =
        0;  // chunks, attachments and other parts whose CRC is wrong: nothing is read of them
    std::vector<std::string> flaws;  // in words, with the place, the first twenty
};

McapScan scan_mcap(Bytes file, McapVisitor& visitor);

}  // namespace thimble
