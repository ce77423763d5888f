// A dissector of Wireshark in Lua, made of the schema: a new message or field needs no line here.
#include <algorithm>

#include <flatbuffers/reflection.h>
#include <fmt/format.h>

#include "common/network_settings.hpp"
#include "common/version.hpp"
#include "session/log/packet_fields.hpp"
#include "thimble/log/log_export.hpp"

namespace thimble {
namespace {

// {0} version, {1} topics by port, {2} kinds and their fields, {3} number of ports.
constexpr const char* kScript =
    R"(-- Thimble's messages in Wireshark and tshark, made by thimble {0} (thimble log dissector).
-- Put it into Wireshark's folder of personal plugins, or say -X lua_script:FILE. Sealed datagrams show their seal alone.
local thimble = Proto("thimble", "Thimble")
thimble.prefs.base_port = Pref.uint("Base port", 27000, "[network] base_port of the session")
local topics = {{{1}}}
local fields, kinds = {{}}, {{}}
local function kind(name, at, size) kinds[#kinds + 1] = {{name = name, at = at, size = size, fields = {{}}}} end
local function field(name, what, make, offset, size, text, values)
    local its = kinds[#kinds]
    local key = its.name .. "." .. name
    fields[key] = make("thimble." .. key, what, values and base.DEC or nil, values)
    its.fields[#its.fields + 1] = {{key = key, offset = offset, size = size, text = text}}
end
{2}local all = {{}}
for _, one in pairs(fields) do all[#all + 1] = one end
local sealed = ProtoField.bytes("thimble.sealed", "Sealed datagram")
all[#all + 1] = sealed
thimble.fields = all

-- Where the table's struct stands in the datagram; nil: it is absent, or cut off.
local function place(tvb, entry)
    local root = tvb(0, 4):le_uint()
    if root + 4 > tvb:len() then return nil end
    local list = root - tvb(root, 4):le_int()
    if list < 0 or list + 4 > tvb:len() or entry.at + 2 > tvb(list, 2):le_uint() or list + entry.at + 2 > tvb:len() then return nil end
    local offset = tvb(list + entry.at, 2):le_uint()
    if offset == 0 or root + offset + entry.size > tvb:len() then return nil end
    return root + offset
end

local function add(tvb, tree, entry, start)
    local part = tree:add(thimble, tvb(start, entry.size), entry.name)
    for _, one in ipairs(entry.fields) do
        local range = tvb(start + one.offset, one.size)
        if one.text then part:add(fields[one.key], range, range:stringz()) else part:add_le(fields[one.key], range) end
    end
end

function thimble.dissector(tvb, info, tree)
    info.cols.protocol = "THIMBLE"
    local top = tree:add(thimble, tvb())
    if tvb:len() < 12 or tvb(4, 4):string() ~= "THM1" then
        top:add(sealed, tvb())
        info.cols.info = "sealed"
        return tvb:len()
    end
    local words = {{}}
    for _, entry in ipairs(kinds) do
        local start = place(tvb, entry)
        if start then
            add(tvb, top, entry, start)
            if entry.name ~= "header" then words[#words + 1] = entry.name end
        end
    end
    local topic = topics[(info.dst_port - thimble.prefs.base_port) % {3}]
    info.cols.info = table.concat(words, ", ") .. " " .. (topic or "")
    return tvb:len()
end

thimble:register_heuristic("udp", function(tvb, info, tree)
    if tvb:len() < 12 or tvb(4, 4):string() ~= "THM1" then return false end
    thimble.dissector(tvb, info, tree)
    return true
end)
DissectorTable.get("udp.port"):add_for_decode_as(thimble)
)";

struct LuaType {
    const char* make;
    std::size_t bytes;
};

LuaType lua_type(const PacketField& field) {
    if (field.elements > 0) return {"ProtoField.string", field.elements};
    const auto type = static_cast<reflection::BaseType>(field.type);
    const std::size_t bytes = flatbuffers::GetTypeSize(type);
    switch (type) {
        case reflection::BaseType::Double:
            return {"ProtoField.double", bytes};
        case reflection::BaseType::Float:
            return {"ProtoField.float", bytes};
        case reflection::BaseType::Bool:
            return {"ProtoField.bool", bytes};
        case reflection::BaseType::ULong:
            return {"ProtoField.uint64", bytes};
        case reflection::BaseType::Long:
            return {"ProtoField.int64", bytes};
        case reflection::BaseType::Int:
            return {"ProtoField.int32", bytes};
        case reflection::BaseType::UShort:
            return {"ProtoField.uint16", bytes};
        case reflection::BaseType::UByte:
            return {"ProtoField.uint8", bytes};
        default:
            return {"ProtoField.uint32", bytes};
    }
}

std::string field_line(const PacketField& field) {
    const LuaType type = lua_type(field);
    const std::string unit = unit_of(field.name);
    std::string values;
    for (const auto& [value, name] : field.names) values += fmt::format("[{}]=\"{}\",", value, name);
    return fmt::format("field(\"{}\", \"{}\", {}, {}, {}, {}{})\n", field.name,
                       field.name + (unit.empty() ? "" : " (" + unit + ")"), type.make, field.offset,
                       type.bytes, field.elements > 0, values.empty() ? "" : ", {" + values + "}");
}

std::string kind_lines(const PacketPart& part) {
    std::size_t size = 0;
    std::string lines;
    for (const PacketField& field : part.fields) {
        size = std::max(size, field.offset + lua_type(field).bytes);
        lines += field_line(field);
    }
    return fmt::format("kind(\"{}\", {}, {})\n", part.name, part.table_offset, size) + lines;
}

}  // namespace

std::string wireshark_dissector() {
    const PacketFields fields;
    std::string topics, kinds = kind_lines(fields.header());
    for (std::size_t i = 0; i < kPortCount; ++i)
        topics += fmt::format("[{}]=\"{}\",", i, flow(static_cast<Port>(i)).topic);
    for (const PacketPart& part : fields.kinds()) kinds += kind_lines(part);
    return fmt::format(kScript, kVersion, topics, kinds, kPortCount);
}

}  // namespace thimble
