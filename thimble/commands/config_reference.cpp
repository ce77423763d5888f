#include "thimble/commands/config_reference.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <set>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/json_text.hpp"
#include "netem/profiles/profiles.hpp"
#include "session/settings/system_settings.hpp"
#include "slave_sim/scene_file.hpp"

namespace thimble {
namespace {

using Keys = std::map<std::string, KeyDeclaration>;

// Keys that must stand beside some others, so that the reader asks for these.
constexpr std::array<std::string_view, 8> kSessionCompanions{
    "session = { subject = \"human\", participant = \"P01\" }",
    "netem.needle.timeline = [{ at_s = 1, loss = 0.1 }]",
    "netem.force.timeline = [{ at_s = 1, loss = 0.1 }]",
    "netem.needle = { loss = 0.01 }",
    "netem.force = { loss = 0.01 }",
    "netem.needle = { loss = { model = \"gilbert\", share = 0.01 } }",
    "netem.force = { loss = { model = \"gilbert\", share = 0.01 } }",
    "cutaneous.device = \"drives\""};
constexpr std::array<std::string_view, 2> kSceneCompanions{
    "fixture = [{ event = [{ time_s = 1 }] }]",
    "fixture = [{ event = [{ after_contact_s = 1, position_m = 0 }] }]"};
constexpr std::array<std::string_view, 6> kProfileCompanions{
    "up = { loss = 0.01 }",
    "down = { loss = 0.01 }",
    "change = [{ loss = 0.01 }]",
    "up = { loss = { model = \"gilbert\", share = 0.01 } }",
    "down = { loss = { model = \"gilbert\", share = 0.01 } }",
    "change = [{ loss = { model = \"gilbert\", share = 0.01 } }]"};

struct KeyUnit {
    std::string_view ending, unit;
};
// The longer of two endings first: "_Ns_per_m" also ends in "_m".
constexpr std::array<KeyUnit, 21> kUnits{{
    {"_m2_per_s3", "m²/s³"},
    {"_Ns_per_m", "N s/m"},
    {"_N_per_m", "N/m"},
    {"_N_per_s", "N/s"},
    {"_m_per_s", "m/s"},
    {"_m_per_count", "m/count"},
    {"_bits_per_s", "bit/s"},
    {"_per_Nm", "1/(N m)"},
    {"counts_per_turn", "counts/turn"},
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

std::string in_one_list(std::string path) {
    for (std::size_t open = path.find('['); open != std::string::npos; open = path.find('[', open + 1)) {
        path.erase(open + 1, path.find(']', open) - open - 1);
    }
    return path;
}

// A file in which the key, maybe of a table in a list, has this value.
std::string file_with(const std::string& path, const std::string& value) {
    const std::size_t list = path.find("[].");
    if (list == std::string::npos) return fmt::format("{} = {}\n", path, value);
    return fmt::format("{} = [{{ {} = {} }}]\n", path.substr(0, list), path.substr(list + 3), value);
}

class Walk {
  public:
    using Reader = std::function<void(const ConfigFile&)>;

    Walk(Reader read, std::span<const std::string_view> companions)
        : read_(std::move(read)), companions_(companions) {}

    Keys all() {
        ask("");
        for (const std::string_view text : companions_) ask(std::string(text));
        // Files that follow from what was noted so far, until nothing new comes.
        while (!waiting_.empty()) {
            const std::string text = *waiting_.begin();
            waiting_.erase(waiting_.begin());
            ask(text);
        }
        return keys_;
    }

  private:
    void ask(const std::string& text) {
        if (!asked_.insert(text).second) return;
        try {
            ConfigFile file = ConfigFile::parse(text, "reference");
            file.note_declarations();
            try {
                read_(file);
            } catch (const Error&) {
                // A file that is incomplete: what was asked for until then counts.
            }
            for (const auto& [path, declared] : file.declarations()) note(in_one_list(path), declared);
        } catch (const Error&) {
            // A value that cannot stand here: two lists within each other.
        }
    }

    void note(const std::string& path, const KeyDeclaration& declared) {
        const auto [at, is_new] = keys_.emplace(path, declared);
        if (at->second.fallback == "nan") at->second.fallback.clear();  // a reader's "none"
        if (!is_new && at->second.type.find(declared.type) == std::string::npos) {
            at->second.type += " or " + declared.type;
        }
        if (!is_new && at->second.range.empty()) at->second.range = declared.range;
        for (const std::string& choice : declared.choices) {
            later(file_with(path, fmt::format("\"{}\"", choice)));
        }
        if (declared.type.find("table") != std::string::npos) {
            const bool several = declared.type.find("tables") != std::string::npos;
            later(file_with(path, several ? "[{}]" : "{}"));
        }
    }

    void later(const std::string& text) {
        if (asked_.count(text) == 0) waiting_.insert(text);
    }

    Reader read_;
    std::span<const std::string_view> companions_;
    Keys keys_;
    std::set<std::string> asked_;
    std::set<std::string> waiting_;
};

// Empty for a key that stands in no table.
std::string table_of(const std::string& path) {
    const std::size_t dot = path.rfind('.');
    return dot == std::string::npos ? "" : path.substr(0, dot);
}

std::string what_it_may_be(const KeyDeclaration& declared) {
    if (declared.choices.empty()) return declared.range;
    return fmt::format("`\"{}\"`", fmt::join(declared.choices, "\"`, `\""));
}

std::string line_of(std::string_view key, const KeyDeclaration& declared) {
    return fmt::format("| `{}` | {} | {} | {} | {} |\n", key, declared.type, unit_of_key(key),
                       declared.fallback.empty() ? "" : fmt::format("`{}`", declared.fallback),
                       what_it_may_be(declared));
}

}  // namespace

Keys session_file_keys() {
    return Walk([](const ConfigFile& file) { read_system_settings(file); }, kSessionCompanions).all();
}

Keys scene_file_keys() {
    return Walk([](const ConfigFile& file) { read_scene(file, "reference"); }, kSceneCompanions).all();
}

Keys profile_file_keys() {
    const FileFinder none = [](std::string_view name) -> std::string {
        throw Error(ExitCode::kUsage, fmt::format("{}: no file stands beside the reference", name));
    };
    return Walk([none](const ConfigFile& file) { read_profile(file, "reference", none); }, kProfileCompanions)
        .all();
}

std::string unit_of_key(std::string_view key) {
    const auto found = std::find_if(kUnits.begin(), kUnits.end(),
                                    [key](const KeyUnit& unit) { return key.ends_with(unit.ending); });
    return found == kUnits.end() ? "" : std::string(found->unit);
}

std::string keys_as_markdown(const Keys& keys) {
    std::map<std::string, std::string> tables;
    for (const auto& [path, declared] : keys) {
        if (declared.type == "table" || declared.type == "tables") continue;
        tables[table_of(path)] += line_of(path.substr(path.rfind('.') + 1), declared);
    }
    // Links and pages have the same keys several times over.
    std::map<std::string, std::vector<std::string>> same;
    for (const auto& [table, lines] : tables) same[lines].push_back(table);
    std::string text;
    for (const auto& [table, lines] : tables) {
        const std::vector<std::string>& together = same[lines];
        if (together.front() != table) continue;
        text += table.empty() ? "## Before the first table\n"
                              : fmt::format("## [{}]\n", fmt::join(together, "], ["));
        text += fmt::format(
            "\n| key | type | unit | default | range |\n| --- | --- | --- | --- | --- |\n{}\n", lines);
    }
    return text;
}

std::string keys_as_json(const Keys& keys) {
    nlohmann::ordered_json all;
    for (const auto& [path, declared] : keys) {
        all[path] = {{"type", declared.type},
                     {"default", declared.fallback},
                     {"range", declared.range},
                     {"choices", declared.choices}};
    }
    return json_text(all, 2) + "\n";
}

}  // namespace thimble
