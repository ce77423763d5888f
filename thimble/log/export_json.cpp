#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/json_text.hpp"
#include "thimble/log/log_export.hpp"

namespace thimble {
namespace {

nlohmann::ordered_json part_of(Bytes packet, const PacketPart& part, const PacketFields& fields) {
    nlohmann::ordered_json object = nlohmann::ordered_json::object();
    const std::vector<FieldValue> values = fields.values(packet, part);
    for (std::size_t i = 0; i < values.size(); ++i) {
        // A number that is not finite becomes null.
        std::visit([&](const auto& v) { object[part.fields[i].name] = v; }, values[i]);
    }
    return object;
}

std::string hexadecimal(Bytes bytes) {
    std::string text;
    for (const std::uint8_t byte : bytes) text += fmt::format("{:02x}", byte);
    return text;
}

// Null where the message is none; else its kind, and `packet` may be read as long as `aligned` lives.
const PacketPart* read_packet(const MergedMessage& m, const PacketFields& fields,
                              std::vector<std::uint64_t>& aligned, Bytes& packet) {
    return verify_packet(m.message.data, aligned, packet) ? fields.kind_of(packet) : nullptr;
}

}  // namespace

std::string to_json(const MergedMessage& m, const PacketFields& fields) {
    nlohmann::ordered_json line{{"file", m.file->name()},
                                {"topic", m.topic->topic},
                                {"direction", m.topic->sent ? "sent" : "received"},
                                {"log_time_ns", m.message.log_time_ns},
                                {"publish_time_ns", m.message.publish_time_ns},
                                {"session_time_ns", m.session_time_ns}};
    std::vector<std::uint64_t> aligned;
    Bytes packet;
    const PacketPart* kind = read_packet(m, fields, aligned, packet);
    if (kind == nullptr) {
        line["bytes"] = hexadecimal(m.message.data);
    } else {
        line["header"] = part_of(packet, fields.header(), fields);
        line[kind->name] = part_of(packet, *kind, fields);
    }
    // Text that is no UTF-8 came from outside. Its bad bytes are replaced.
    return json_text(line);
}

std::string to_line(const MergedMessage& m, const PacketFields& fields, std::int64_t zero_ns) {
    std::string line =
        fmt::format("{:12.6f} {} {} {}", 1e-9 * static_cast<double>(m.session_time_ns - zero_ns),
                    m.file->name(), m.topic->sent ? "->" : "<-", m.topic->topic);
    std::vector<std::uint64_t> aligned;
    Bytes packet;
    const PacketPart* kind = read_packet(m, fields, aligned, packet);
    if (kind == nullptr) return line + " bytes=" + hexadecimal(m.message.data);
    line += fmt::format(" #{} {}", m.message.sequence, kind->name);
    const std::vector<FieldValue> values = fields.values(packet, *kind);
    for (std::size_t i = 0; i < values.size(); ++i) {
        line += fmt::format(" {}={}", kind->fields[i].name, to_text(values[i]));
    }
    return line;
}

}  // namespace thimble
