#include "session/log/packet_fields.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <string>

#include <flatbuffers/reflection.h>
#include <fmt/format.h>

#include "common/codec.hpp"

namespace thimble {
namespace {

using reflection::BaseType;

std::vector<std::pair<std::int64_t, std::string>> enum_names(const reflection::Schema& schema,
                                                             const reflection::Type& type) {
    std::vector<std::pair<std::int64_t, std::string>> names;
    if (type.base_type() == BaseType::Obj || type.index() < 0) return names;
    for (const auto* value : *schema.enums()->Get(static_cast<unsigned>(type.index()))->values()) {
        names.emplace_back(value->value(), value->name()->str());
    }
    return names;
}

// Fields of a struct in the order of its bytes. A struct within it gives its own; one that has a single field (a text) has the
// name under which it stands there.
void add_fields(const reflection::Schema& schema, const reflection::Object& object, std::size_t start,
                const std::string& only_name, std::vector<PacketField>& fields) {
    std::vector<const reflection::Field*> ordered(object.fields()->begin(), object.fields()->end());
    std::sort(ordered.begin(), ordered.end(),
              [](const auto* a, const auto* b) { return a->offset() < b->offset(); });
    for (const reflection::Field* field : ordered) {
        const reflection::Type& type = *field->type();
        const std::size_t offset = start + field->offset();
        const std::string name = only_name.empty() ? field->name()->str() : only_name;
        if (type.base_type() == BaseType::Obj) {
            const auto& inner = *schema.objects()->Get(static_cast<unsigned>(type.index()));
            add_fields(schema, inner, offset, inner.fields()->size() == 1 ? name : "", fields);
        } else if (type.base_type() != BaseType::Array) {
            fields.push_back({name, offset, type.base_type(), 0, enum_names(schema, type)});
        } else if (type.element() == BaseType::UByte) {
            fields.push_back({name, offset, BaseType::UByte, type.fixed_length()});
        } else {
            const std::size_t size = flatbuffers::GetTypeSize(type.element());
            for (std::size_t i = 0; i < type.fixed_length(); ++i)
                fields.push_back({fmt::format("{}_{}", name, i), offset + i * size, type.element(), 0});
        }
    }
}

FieldValue value_at(const std::uint8_t* at, const PacketField& field, EnumValues enums) {
    if (field.elements > 0) {
        const auto* text = static_cast<const char*>(static_cast<const void*>(at));
        return std::string(text, strnlen(text, field.elements));
    }
    const auto type = static_cast<BaseType>(field.type);
    if (type == BaseType::Double || type == BaseType::Float) return flatbuffers::GetAnyValueF(type, at);
    const std::int64_t number = flatbuffers::GetAnyValueI(type, at);
    for (const auto& [value, name] : field.names) {
        if (value == number && enums == EnumValues::kNames) return name;
    }
    // A text like the names, so that a column has one type.
    if (!field.names.empty() && enums == EnumValues::kNames) return std::to_string(number);
    if (type == BaseType::Bool) return number != 0;
    if (type == BaseType::ULong) return static_cast<std::uint64_t>(number);
    return number;
}

const flatbuffers::Table& table_of(Bytes packet) {
    return *flatbuffers::GetRoot<flatbuffers::Table>(packet.data());
}

}  // namespace

PacketFields::PacketFields() {
    const reflection::Schema& schema = *reflection::GetSchema(wire_schema().data());
    for (const auto* field : *schema.root_table()->fields()) {
        PacketPart part;
        part.name = field->name()->str();
        part.table_offset = field->offset();
        add_fields(schema, *schema.objects()->Get(static_cast<unsigned>(field->type()->index())), 0, "",
                   part.fields);
        if (part.name == "header") {
            header_ = std::move(part);
        } else {
            kinds_.push_back(std::move(part));
        }
    }
}

const PacketPart* PacketFields::kind_of(Bytes packet) const {
    const PacketPart* found = nullptr;
    for (const PacketPart& kind : kinds_) {
        if (table_of(packet).GetStruct<const std::uint8_t*>(kind.table_offset) == nullptr) continue;
        if (found != nullptr) return nullptr;
        found = &kind;
    }
    return found;
}

std::vector<FieldValue> PacketFields::values(Bytes packet, const PacketPart& part, EnumValues enums) const {
    std::vector<FieldValue> values;
    const auto* bytes = table_of(packet).GetStruct<const std::uint8_t*>(part.table_offset);
    if (bytes == nullptr) return values;
    values.reserve(part.fields.size());
    for (const PacketField& field : part.fields)
        values.push_back(value_at(bytes + field.offset, field, enums));
    return values;
}

bool verify_packet(Bytes bytes, std::vector<std::uint64_t>& aligned, Bytes& packet) {
    if (bytes.empty() || bytes.size() > kMaxDatagramBytes) return false;
    aligned.resize((bytes.size() + 7) / 8);
    std::memcpy(aligned.data(), bytes.data(), bytes.size());
    packet = {static_cast<const std::uint8_t*>(static_cast<const void*>(aligned.data())), bytes.size()};
    const Decoded decoded = decode(packet);
    return decoded.message || decoded.refusal == Refusal::kNotOneBody ||
           decoded.refusal == Refusal::kNotFinite || decoded.refusal == Refusal::kOutOfRange;
}

std::string to_text(const FieldValue& value) {
    return std::visit([](const auto& v) { return fmt::format("{}", v); }, value);
}

std::string unit_of(std::string_view field) {
    constexpr std::array<std::pair<std::string_view, std::string_view>, 6> kUnits{
        {{"_m_per_s", "m/s"}, {"_m", "m"}, {"_N", "N"}, {"_J", "J"}, {"_ns", "ns"}, {"_s", "s"}}};
    while (!field.empty() && (std::isdigit(static_cast<unsigned char>(field.back())) != 0))
        field.remove_suffix(1);
    if (!field.empty() && field.back() == '_') field.remove_suffix(1);
    for (const auto& [ending, unit] : kUnits) {
        if (field.ends_with(ending)) return std::string(unit);
    }
    return {};
}

}  // namespace thimble
