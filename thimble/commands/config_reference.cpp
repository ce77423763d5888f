#include "thimble/commands/config_reference.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "common/duration_text.hpp"
#include "common/json_text.hpp"
#include "netem/profiles/profiles.hpp"
#include "session/settings/system_settings.hpp"
#include "slave_sim/scene_file.hpp"

namespace thimble {
namespace {

using Keys = std::vector<KeyDeclaration>;
using Json = nlohmann::ordered_json;

struct KeyUnit {
    std::string_view ending, unit;
};
// The longer of two endings first: "_Ns_per_m" also ends in "_m".
constexpr std::array<KeyUnit, 22> kUnits{{
    {"_m2_per_s3", "m²/s³"},
    {"_Ns_per_m", "N s/m"},
    {"_N_per_m", "N/m"},
    {"_N_per_s", "N/s"},
    {"_m_per_s", "m/s"},
    {"_m_per_count", "m/count"},
    {"_bits_per_s", "bit/s"},
    {"_per_Nm", "1/(N m)"},
    {"counts_per_turn", "counts/turn"},
    {"_per_N", "1/N"},
    {"_exponent_per_m", "1/m"},
    {"_Hz", "Hz"},
    {"_kg", "kg"},
    {"_rad", "rad"},
    {"_Nm", "N m"},
    {"_bytes", "byte"},
    {"_bits", "bit"},
    {"_packets", "packet"},
    {"_N", "N"},
    {"_J", "J"},
    {"_m", "m"},
    {"_s", "s"},
}};

// The type of a key and its name in JSON Schema.
constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kJsonTypes{
    {{"number", "number"},
     {"whole number", "integer"},
     {"true or false", "boolean"},
     {"text", "string"},
     {"list of numbers", "array"},
     {"list of texts", "array"},
     {"table", "object"},
     {"tables", "object"}}};

bool is(const KeyDeclaration& key, std::string_view type) {
    return std::find(key.types.begin(), key.types.end(), type) != key.types.end();
}

std::string type_of(const KeyDeclaration& key) { return fmt::format("{}", fmt::join(key.types, " or ")); }

std::string range_of(const KeyDeclaration& key) {
    return key.low.empty() ? "" : fmt::format("{} to {}", key.low, key.high);
}

std::string line_of(const KeyDeclaration& key) {
    const std::string name = key.path.substr(key.path.rfind('.') + 1);
    const std::string choices = fmt::format("`\"{}\"`", fmt::join(key.choices, "\"`, `\""));
    return fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", name, type_of(key), unit_of_key(name),
                       key.fallback.empty() ? "" : fmt::format("`{}`", key.fallback),
                       key.choices.empty() ? range_of(key) : choices, key.help);
}

// Texts by name, in the order in which the names came.
using Texts = std::vector<std::pair<std::string, std::string>>;

std::string& text_of(Texts& texts, const std::string& name) {
    const auto is_it = [&name](const auto& one) { return one.first == name; };
    const auto found = std::find_if(texts.begin(), texts.end(), is_it);
    return found != texts.end() ? found->second : texts.emplace_back(name, "").second;
}

Json object_schema(const Keys& keys, const std::string& table);

// Seconds may be text with a unit (common/duration_text.hpp).
bool may_have_unit(const KeyDeclaration& key) {
    return holds_seconds(key.path) && (is(key, "number") || is(key, "list of numbers"));
}
// The numbers of std::from_chars, and both letters that people type for micro.
constexpr const char* kDurationPattern =
    "^[+]?-?([0-9]+[.]?[0-9]*|[.][0-9]+)([eE][-+]?[0-9]+)? ?(ns|us|\u00b5s|\u03bcs|ms|s|min|h)$";

// A delay of seconds needs its unit: as a bare number it is hardly meant.
void add_range(const KeyDeclaration& key, Json& schema) {
    schema["minimum"] = Json::parse(key.low);
    schema["maximum"] = Json::parse(key.high);
    const std::string name = key.path.substr(key.path.rfind('.') + 1);
    if (may_have_unit(key) && !doubt_seconds(name, kLongestPath_s).empty() &&
        schema["maximum"] >= kLongestPath_s)
        schema["exclusiveMaximum"] = kLongestPath_s;
}

Json element_schema(const KeyDeclaration& key) {
    if (is(key, "list of texts")) return {{"type", "string"}};
    Json schema{{"type", "number"}};
    add_range(key, schema);
    if (may_have_unit(key)) {
        schema["type"] = {"number", "string"};
        schema["pattern"] = kDurationPattern;
    }
    return schema;
}

// Each word of JSON Schema speaks of its own type only, so a key of several types has the words of all.
Json key_schema(const Keys& keys, const KeyDeclaration& key) {
    Json schema = Json::object();
    if (is(key, "table")) schema = object_schema(keys, key.path + ".");
    if (is(key, "tables")) {
        const Json entry = object_schema(keys, key.path + "[].");
        schema = entry;
        schema["items"] = entry;
    }
    Json types = Json::array();
    for (const auto& [type, json] : kJsonTypes) {
        if (is(key, type)) types.push_back(json);
    }
    if (is(key, "tables")) types.push_back("array");
    if (is(key, "number") && may_have_unit(key)) {
        types.push_back("string");
        schema["pattern"] = kDurationPattern;
    }
    schema["type"] = types.size() == 1 ? types.front() : types;
    if (is(key, "list of numbers") || is(key, "list of texts")) {
        schema["items"] = element_schema(key);
    } else if (!key.low.empty()) {
        add_range(key, schema);
    }
    if (!key.choices.empty()) schema["enum"] = key.choices;
    if (!key.fallback.empty()) schema["default"] = Json::parse(key.fallback);
    if (!key.help.empty()) schema["description"] = key.help;
    return schema;
}

// Of the keys whose path is `table`, which ends in a dot, and a name.
Json object_schema(const Keys& keys, const std::string& table) {
    Json properties = Json::object();
    for (const KeyDeclaration& key : keys) {
        if (!key.path.starts_with(table) || key.path.find('.', table.size()) != std::string::npos) continue;
        properties[key.path.substr(table.size())] = key_schema(keys, key);
    }
    return {{"type", "object"}, {"properties", properties}, {"additionalProperties", false}};
}

template <class Read>
Keys described_by(const Read& read) {
    const ConfigFile description = ConfigFile::description();
    read(description);
    return description.declarations();
}

}  // namespace

Keys session_file_keys() { return described_by(read_system_settings); }

Keys scene_file_keys() {
    return described_by([](const ConfigFile& file) { read_scene(file, "reference"); });
}

Keys page_file_keys() { return described_by(read_page_set); }

Keys profile_file_keys() {
    return described_by([](const ConfigFile& file) { read_profile(file, "reference", {}); });
}

std::string unit_of_key(std::string_view key) {
    const auto found = std::find_if(kUnits.begin(), kUnits.end(),
                                    [key](const KeyUnit& unit) { return key.ends_with(unit.ending); });
    return found == kUnits.end() ? "" : std::string(found->unit);
}

std::string keys_as_markdown(const Keys& keys) {
    Texts tables;
    for (const KeyDeclaration& key : keys) {
        if (key.types.size() == 1 && (is(key, "table") || is(key, "tables"))) continue;
        const std::size_t dot = key.path.rfind('.');
        const std::string table = dot == std::string::npos ? "Before the first table"
                                                           : fmt::format("[{}]", key.path.substr(0, dot));
        text_of(tables, table) += line_of(key);
    }
    // Links and pages have the same keys several times over.
    Texts names_of;
    for (const auto& [name, lines] : tables) {
        std::string& names = text_of(names_of, lines);
        names += (names.empty() ? "" : ", ") + name;
    }
    std::string text;
    for (const auto& [lines, names] : names_of) {
        text += fmt::format(
            "## {}\n\n| key | type | unit | default | range | meaning |\n| --- | --- | --- | --- | --- | --- "
            "|\n{}\n",
            names, lines);
    }
    return text;
}

std::string keys_as_json(const Keys& keys) {
    Json all;
    for (const KeyDeclaration& key : keys) {
        all[key.path] = {{"type", type_of(key)},
                         {"default", key.fallback},
                         {"range", range_of(key)},
                         {"choices", key.choices},
                         {"help", key.help}};
    }
    return json_text(all, 2) + "\n";
}

std::string keys_as_schema(const Keys& keys) {
    Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"}};
    schema.update(object_schema(keys, ""));
    return json_text(schema, 2) + "\n";
}

}  // namespace thimble
