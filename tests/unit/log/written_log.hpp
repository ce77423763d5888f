// One flow as one of its ends wrote it down: a log made by a test.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "common/codec.hpp"
#include "common/log/mcap_writer.hpp"
#include "common/runtime/log/log_file.hpp"

namespace thimble {

struct WrittenMessage {
    std::uint32_t sequence = 0;
    std::int64_t log_time_ns = 0;
};

struct WrittenLog {
    std::string program = "thimble-master", boot = "a";
    std::string direction = "sent", topic = "/master/needle_command";
    std::string realtime_ns = "0";  // when its clock was zero
    std::vector<WrittenMessage> messages;
    std::function<void(McapWriter&)> more{};
    std::vector<Message> bodies{Message{{7, {}, 0, 1, Role::kMaster}, NeedleCommand{}}};
    bool body_by_body = false;  // message i has body i; else each has all of them

    void write(const std::filesystem::path& path) const {
        LogFile file(path);
        McapWriter writer(file, "test");
        const std::uint16_t schema = writer.add_schema(kWireSchemaName, "flatbuffer", wire_schema());
        writer.add_metadata("thimble", {{"program", program},
                                        {"machine_boot", boot},
                                        {"monotonic_ns", "0"},
                                        {"realtime_ns", realtime_ns}});
        if (more) more(writer);
        const std::uint16_t channel =
            writer.add_channel(schema, topic, "flatbuffer", {{"direction", direction}});
        Encoder encoder;
        for (std::size_t i = 0; i < messages.size(); ++i) {
            const WrittenMessage& m = messages[i];
            for (Message body : body_by_body ? std::span(bodies).subspan(i, 1) : std::span(bodies)) {
                body.header.sequence = m.sequence;
                body.header.send_time = from_nanoseconds(1000 * static_cast<std::int64_t>(m.sequence));
                writer.add_message({channel, m.sequence, static_cast<std::uint64_t>(m.log_time_ns), 0,
                                    encoder.encode(body)});
            }
        }
        writer.finish();
    }
};

// The session's word that the master's clock is so far ahead of its own.
inline void say_master_is_ahead(McapWriter& writer, const char* offset_s) {
    writer.add_metadata("clock_offset", {{"node", "master"}, {"offset_s", offset_s}, {"at_ns", "0"}});
}

}  // namespace thimble
