// The files in deploy/board, and fragments of session files: all that reads TOML itself.
#include <array>
#include <optional>
#include <sstream>
#include <string_view>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "common/error.hpp"
#include "session/records/trajectory_file.hpp"
#include "study/board/board_plan.hpp"

namespace thimble {
namespace {

toml::table parsed(const std::string& text, const std::string& name) {
    try {
        return toml::parse(text);
    } catch (const toml::parse_error& error) {
        throw Error(ExitCode::kUsage, "{}: not TOML: {}", name, error.description());
    }
}

toml::table load(const std::filesystem::path& file) {
    try {
        return toml::parse_file(file.string());
    } catch (const toml::parse_error& error) {
        throw Error(ExitCode::kUsage, "{}:{}: {}: is Thimble installed completely?", file.string(),
                    error.source().begin.line, error.description());
    }
}

void join(toml::table& into, const toml::table& from) {
    for (const auto& [key, node] : from) {
        toml::table* const mine = into[key.str()].as_table();
        if (mine != nullptr && node.is_table()) {
            join(*mine, *node.as_table());
        } else {
            into.insert_or_assign(key.str(), node);
        }
    }
}

std::string text_of(const toml::table& table) {
    std::ostringstream text;
    text << table << '\n';
    return text.str();
}

// name and about are ours, the rest is the session's.
BoardEntry entry_of(const toml::table& table) {
    BoardEntry entry{table["name"].value_or(std::string()), table["about"].value_or(std::string()), {}};
    entry.plugin = table["control"]["plugin"].value_or(std::string());
    toml::table keys = table;
    keys.erase("name");
    keys.erase("about");
    entry.keys = text_of(keys);
    return entry;
}

std::vector<BoardEntry> entries(const toml::table& file, const std::string& kind,
                                const std::filesystem::path& path) {
    std::vector<BoardEntry> list;
    if (const toml::array* const tables = file[kind].as_array()) {
        list.reserve(tables->size());
        for (const toml::node& node : *tables) {
            const toml::table* const table = node.as_table();
            if (table == nullptr || !(*table)["name"].is_string())
                throw Error(ExitCode::kUsage, "{}: an entry of [[{}]] has no name", path.string(), kind);
            list.push_back(entry_of(*table));
        }
    }
    if (list.empty()) throw Error(ExitCode::kUsage, "{}: has no [[{}]]", path.string(), kind);
    return list;
}

struct Factors {
    std::vector<BoardEntry> network, hands, tissue, scene;
};

// The level that a condition names, else the factor's first.
const BoardEntry& level(const std::vector<BoardEntry>& levels, const toml::table& row, const char* factor) {
    const std::string name = row[factor].value_or(levels.front().name);
    for (const BoardEntry& one : levels)
        if (one.name == name) return one;
    throw Error(ExitCode::kUsage,
                "conditions.toml: {} = \"{}\": unknown level; choose one that the file defines", factor,
                name);
}

// Of the ideal network.
std::string network_keys(double delay_s, const BoardCondition& condition) {
    std::string keys = fmt::format("session.delays_s = [{:f}]\n", delay_s);
    if (condition.jitter_s > 0)
        keys += fmt::format("netem.force.jitter = \"uniform\"\nnetem.force.jitter_spread_s = {}\n",
                            condition.jitter_s);
    if (condition.loss > 0)
        keys += fmt::format("netem.force.loss = {0}\nnetem.needle.loss = {0}\n", condition.loss);
    return keys;
}

BoardCondition condition_of(const toml::table& row, const Factors& factors) {
    BoardCondition condition;
    const BoardEntry& network = level(factors.network, row, "network");
    const bool ideal = network.name == factors.network.front().name;
    const double delay_s = row["delay_s"].value_or(0.0);
    condition.jitter_s = row["jitter_s"].value_or(0.0);
    condition.loss = row["loss"].value_or(0.0);
    condition.network = network.name;
    condition.name = ideal ? delay_in_names(delay_s) : network.name;
    if (condition.jitter_s > 0) condition.name += "+jitter";
    if (condition.loss > 0) condition.name += "+loss";
    std::vector<std::string> fragments{network.keys};
    if (ideal) fragments.push_back(network_keys(delay_s, condition));
    const auto add = [&](const std::vector<BoardEntry>& levels, const char* factor) {
        const BoardEntry& chosen = level(levels, row, factor);
        fragments.push_back(chosen.keys);
        if (chosen.name != levels.front().name) condition.name += "+" + chosen.name;
        return chosen.name;
    };
    condition.hands = add(factors.hands, "hands");
    condition.tissue = add(factors.tissue, "tissue");
    condition.scene = add(factors.scene, "scene");
    condition.keys = joined_fragments(fragments, condition.name);
    const SystemSettings read = read_system_settings(ConfigFile::parse(condition.keys, condition.name));
    condition.delay_s = to_seconds(read.plan.delays.front());
    return condition;
}

}  // namespace

std::string joined_fragments(std::span<const std::string> fragments, const std::string& name) {
    toml::table all;
    for (const std::string& fragment : fragments) join(all, parsed(fragment, name));
    return text_of(all);
}

BoardPlan read_board(const std::filesystem::path& folder) {
    BoardPlan plan;
    const auto path = folder / "conditions.toml";
    const toml::table conditions = load(path);
    plan.version = conditions["version"].value_or(std::uint32_t{0});
    const Factors factors{entries(conditions, "network", path), entries(conditions, "hands", path),
                          entries(conditions, "tissue", path), entries(conditions, "scene", path)};
    plan.controllers = entries(load(folder / "controllers.toml"), "controller", folder / "controllers.toml");
    plan.codecs = entries(load(folder / "codecs.toml"), "codec", folder / "codecs.toml");
    if (const toml::array* const rows = conditions["condition"].as_array()) {
        plan.conditions.reserve(rows->size());
        for (const toml::node& row : *rows) {
            const toml::table* const table = row.as_table();
            if (table != nullptr) plan.conditions.push_back(condition_of(*table, factors));
        }
    }
    if (plan.conditions.empty()) throw Error(ExitCode::kUsage, "{}: has no condition", path.string());
    return plan;
}

}  // namespace thimble
