// The fields of a logged message by name, as messages.fbs has them: read through the schema, so that a new message or field is
// exported without a line about it here.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/channel.hpp"

namespace thimble {

// Text: of enums and of arrays of bytes.
using FieldValue = std::variant<double, std::int64_t, std::uint64_t, bool, std::string>;

struct PacketField {
    std::string name;          // of an array's element with its number behind: "change_s_3"
    std::size_t offset = 0;    // in its struct
    int type = 0;              // reflection::BaseType
    std::size_t elements = 0;  // of an array of bytes, which is text; else 0
    std::vector<std::pair<std::int64_t, std::string>> names{};  // of an enum's values
};

enum class EnumValues { kNames, kNumbers };

struct PacketPart {
    std::string name;                // "needle_command", "header"
    std::uint16_t table_offset = 0;  // of its struct in the table
    std::vector<PacketField> fields;
};

class PacketFields {
  public:
    PacketFields();
    const PacketPart& header() const { return header_; }
    const std::vector<PacketPart>& kinds() const { return kinds_; }

    // The message's kind. Null if the packet holds no message, or several. `packet` has passed decode().
    const PacketPart* kind_of(Bytes packet) const;
    // In the order of part.fields; empty if the part is not there.
    std::vector<FieldValue> values(Bytes packet, const PacketPart& part,
                                   EnumValues enums = EnumValues::kNames) const;

  private:
    PacketPart header_;
    std::vector<PacketPart> kinds_;
};

// True if the bytes, which may stand anywhere, are a Packet; they are copied to `aligned`, where values() may read them.
bool verify_packet(Bytes bytes, std::vector<std::uint64_t>& aligned, Bytes& packet);

std::string to_text(const FieldValue& value);
// "m/s" of "velocity_needle_m_per_s"; empty where the name has none.
std::string unit_of(std::string_view field);

}  // namespace thimble
