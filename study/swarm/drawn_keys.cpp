#include "study/swarm/drawn_keys.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <initializer_list>
#include <set>
#include <span>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "common/control/control_settings.hpp"
#include "common/error.hpp"
#include "common/math/portable.hpp"
#include "netem/profiles/profiles.hpp"

namespace thimble {
namespace {

constexpr std::uint32_t kMostKeys = 10;

// Of sessions. A codec needs several keys of its table at once, and a plug-in its file: keys drawn one by one would seldom be either.
constexpr double kCodecShare = 0.2, kPluginShare = 0.1;
constexpr double kSecondaryShare = 0.4;  // of a codec's or plug-in's other keys
constexpr std::string_view kCodec = "codec.", kPlugin = "control.plugin",
                           kCompensator = "control.compensator", kPluginKeys = "control.plugin_settings.";

// Tables of programs, machines, people and files.
constexpr std::array<std::string_view, 8> kElsewhere{"network", "security", "runtime",      "launch",
                                                     "log",     "dataset",  "instructions", "protocol"};

// Beyond these a trial takes seconds of a processor, or is only a long wait.
struct Cap {
    std::string_view ending;
    double low, high;
};
constexpr std::array<Cap, 8> kCaps{{{"solver_step_s", 2e-4, 1},
                                    {"master.sample_period_s", 5e-4, 1},
                                    {"percept_period_s", 5e-4, 0.1},
                                    {"refresh_Hz", 1, 240},
                                    {"delay_s", 0, 0.3},
                                    {"jitter_spread_s", 0, 0.1},
                                    {"wave_jitter_s", 0, 0.1},
                                    {"timeline[].at_s", 0, 5}}};

std::string group_of(const std::string& path) {
    const std::size_t dot = path.find('.');
    const std::string table = path.substr(0, dot);
    return table == "netem" ? path.substr(0, path.find('.', dot + 1)) : table;
}

bool has_type(const KeyDeclaration& key, std::string_view type) {
    return std::find(key.types.begin(), key.types.end(), type) != key.types.end();
}

// Of a text that may be more than the description says.
std::vector<std::string_view> texts_of(const KeyDeclaration& key) {
    if (key.path.ends_with("scene")) return {"vessel.toml", "layers.toml", "paper.toml", "experiment2.toml"};
    if (key.path.ends_with("profile")) return profile_names();
    return {key.choices.begin(), key.choices.end()};
}

bool drawable(const KeyDeclaration& key) {
    const std::string table = key.path.substr(0, key.path.find('.'));
    // The swarm writes these for each session.
    const bool own = table == "session" || table == "trial" || key.path == "fixture.position_m";
    if (own || std::find(kElsewhere.begin(), kElsewhere.end(), table) != kElsewhere.end()) return false;
    if (has_type(key, "number") || has_type(key, "whole number") || has_type(key, "true or false"))
        return true;
    return has_type(key, "text") && !texts_of(key).empty();
}

double pick_number(double fallback, double low, double high, RandomStream& draw) {
    const double kind = draw.uniform();
    if (kind < 0.1) return low;
    if (kind < 0.2) return high;
    const double near = std::abs(fallback) > 0 ? fallback : std::min(high, 1.0) * 1e-2;
    if (kind < 0.75) return std::clamp(near * portable::exp(draw.uniform(-1.6, 1.6)), low, high);
    const double least = std::max(low, 1e-6 * std::max(high, 1e-6));
    return std::clamp(least * portable::exp(draw.uniform() * portable::log(high / least)), low, high);
}

std::string draw_number(const KeyDeclaration& key, RandomStream& draw) {
    double low = std::strtod(key.low.c_str(), nullptr), high = std::strtod(key.high.c_str(), nullptr);
    for (const Cap& cap : kCaps) {
        if (!key.path.ends_with(cap.ending)) continue;
        low = std::max(low, cap.low);
        high = std::min(high, cap.high);
    }
    const double value = pick_number(std::strtod(key.fallback.c_str(), nullptr), low, high, draw);
    return has_type(key, "whole number") ? fmt::format("{:.0f}", value) : fmt::format("{:.6g}", value);
}

std::string draw_value(const KeyDeclaration& key, RandomStream& draw) {
    if (has_type(key, "number") || has_type(key, "whole number")) return draw_number(key, draw);
    if (has_type(key, "true or false")) return draw.uniform() < 0.5 ? "true" : "false";
    const auto texts = texts_of(key);
    return fmt::format("\"{}\"", texts[draw.below(static_cast<std::uint32_t>(texts.size()))]);
}

const char* one_of(std::initializer_list<const char*> texts, RandomStream& draw) {
    return texts.begin()[draw.below(static_cast<std::uint32_t>(texts.size()))];
}

// Where the needle is after two seconds and more, so that a trial touches the fixture before its time is over.
DrawnKeys short_session(RandomStream& draw) {
    return {
        {"session.modalities",
         one_of({"[\"HF\"]", "[\"HF\"]", "[\"HF\"]", "[\"CF\"]", "[\"CCF\"]", "[\"VF\"]", "[\"HF\", \"CF\"]"},
                draw)},
        {"session.delays_s", one_of({"[0.0]", "[0.0]", "[0.02]", "[0.05]", "[0.2]"}, draw)},
        {"session.seed", fmt::format("{}", draw.below(1000000))},
        {"trial.contact_hold_s", fmt::format("{:.3f}", draw.uniform(0.05, 0.5))},
        {"trial.timeout_s", fmt::format("{:.3f}", draw.uniform(2, 5))},
        {"trial.peer_wait_s", fmt::format("{:.3f}", draw.uniform(0.3, 1.5))},
        {"fixture.position_m", fmt::format("{:.4f}", draw.uniform(0.021, 0.035))},
    };
}

bool has_key(const DrawnKeys& keys, const std::string& path) {
    return std::any_of(keys.begin(), keys.end(), [&path](const DrawnKey& key) { return key.path == path; });
}

std::string last_name(const std::string& path) { return path.substr(path.rfind('.') + 1); }

// "netem.needle.timeline[].loss" -> "netem.needle.timeline.loss"
std::string without_brackets(std::string path) {
    for (std::size_t at = path.find("[]"); at != std::string::npos; at = path.find("[]")) path.erase(at, 2);
    return path;
}

std::string table_of(const std::string& path) { return path.substr(0, path.rfind('.')); }

struct Line {
    std::string text;
    std::string path;  // of the key; of a header, the table's
};

// An entry of several tables stands before the tables in it.
void open_table(const std::string& table, std::set<std::string>& opened, std::vector<Line>& lines) {
    for (std::size_t end = table.find("[]"); end != std::string::npos; end = table.find("[]", end + 2)) {
        const std::string entry = table.substr(0, end);
        if (opened.insert(entry).second)
            lines.push_back({fmt::format("[[{}]]", without_brackets(entry)), entry + "[]"});
    }
    if (!table.ends_with("[]")) lines.push_back({fmt::format("[{}]", without_brackets(table)), table});
}

std::vector<Line> lines_of(DrawnKeys keys) {
    std::stable_sort(keys.begin(), keys.end(), [](const DrawnKey& a, const DrawnKey& b) {
        return table_of(a.path) < table_of(b.path);
    });
    std::string table;
    std::set<std::string> opened;
    std::vector<Line> lines;
    lines.reserve(3 * keys.size());
    for (const DrawnKey& key : keys) {
        if (table != table_of(key.path)) {
            table = table_of(key.path);
            open_table(table, opened, lines);
        }
        lines.push_back({fmt::format("{} = {}", last_name(key.path), key.value), key.path});
    }
    return lines;
}

// Refusals begin with it and a place, as in "swarm:7:1".
constexpr std::string_view kFile = "swarm";

SystemSettings read(const DrawnKeys& keys) {
    SystemSettings settings = read_system_settings(ConfigFile::parse(keys_text(keys), kFile));
    require_virtual_subjects(settings, kFile);
    return settings;
}

// The path on the line that a refusal names first.
std::string path_at(const std::string& refusal, const DrawnKeys& keys) {
    const std::string mark = fmt::format("{}:", kFile);
    const std::vector<Line> lines = lines_of(keys);
    for (std::size_t at = refusal.find(mark); at != std::string::npos; at = refusal.find(mark, at + 1)) {
        const unsigned long line = std::strtoul(refusal.c_str() + at + mark.size(), nullptr, 10);
        if (line > 0 && line <= lines.size()) return lines[line - 1].path;
    }
    return "";
}

// The last key of that path, or of the table that has it, or one whose name the refusal has.
void remove_named(const std::string& refusal, DrawnKeys& keys) {
    const std::string path = path_at(refusal, keys);
    const auto is_named = [&](const DrawnKey& key) {
        return path.empty() ? refusal.find(last_name(key.path)) != std::string::npos
                            : key.path.starts_with(path);
    };
    const auto named = std::find_if(keys.rbegin(), keys.rend(), is_named);
    if (named == keys.rend()) throw std::logic_error(fmt::format("a refusal that names no key: {}", refusal));
    keys.erase(std::prev(named.base()));
}

// A key that the refusal quotes and that is not there: a reader asks for it beside the others. Null: none.
const KeyDeclaration* asked_for(const std::string& refusal, const DrawnKeys& drawn,
                                const std::vector<KeyDeclaration>& keys) {
    const auto quoted = [&refusal](std::string path) {
        for (std::size_t at = path.find("[]"); at != std::string::npos; at = path.find("[]"))
            path.insert(at + 1, "0");
        return refusal.find(fmt::format("'{}'", path)) != std::string::npos;
    };
    const auto found = std::find_if(keys.begin(), keys.end(), [&](const KeyDeclaration& key) {
        return quoted(key.path) && !has_key(drawn, key.path);
    });
    return found == keys.end() ? nullptr : &*found;
}

void draw_codec(const std::vector<KeyDeclaration>& keys, DrawnKeys& drawn, RandomStream& draw) {
    if (draw.uniform() >= kCodecShare) return;
    for (const KeyDeclaration& key : keys) {
        if (!key.path.starts_with(kCodec)) continue;
        const bool kind = has_type(key, "text");
        if (kind || draw.uniform() < kSecondaryShare) drawn.push_back({key.path, draw_value(key, draw)});
    }
}

// Without a plug-in at hand one of Thimble's own, which use the same interface.
void draw_controller(const std::vector<KeyDeclaration>& keys, DrawnKeys& drawn, RandomStream& draw) {
    if (draw.uniform() >= kPluginShare) return;
    const auto declared = [&keys](std::string_view path) {
        return std::find_if(keys.begin(), keys.end(),
                            [path](const KeyDeclaration& key) { return key.path == path; });
    };
    const bool plugin = declared(kPlugin) != keys.end();
    const KeyDeclaration& chosen = *declared(plugin ? kPlugin : kCompensator);
    drawn.push_back({chosen.path, draw_value(chosen, draw)});
    for (const KeyDeclaration& key : keys)
        if (key.path.starts_with(kPluginKeys) && draw.uniform() < kSecondaryShare)
            drawn.push_back({key.path, draw_value(key, draw)});
}

// The file, and the keys that it declares.
void declare_plugin(const std::filesystem::path& file, std::vector<KeyDeclaration>& keys) {
    const PluginSettings plugin = load_plugin(file);
    keys.push_back({std::string(kPlugin), {"text"}, "", "", "", {std::filesystem::absolute(file)}, ""});
    for (const thimble_controller_key& key : std::span(plugin.table->keys, plugin.table->key_count))
        keys.push_back({std::string(kPluginKeys) + key.name,
                        {"number"},
                        fmt::format("{}", key.fallback),
                        fmt::format("{}", key.low),
                        fmt::format("{}", key.high),
                        {},
                        key.help});
}

// Draws the keys that readers ask for, and removes the keys that they still refuse.
void make_valid(DrawnKeys& drawn, const std::vector<KeyDeclaration>& keys, RandomStream& draw) {
    for (std::uint32_t tries = 0;; ++tries) {
        try {
            read(drawn);
            return;
        } catch (const Error& refusal) {
            const KeyDeclaration* key = tries < kMostKeys ? asked_for(refusal.what(), drawn, keys) : nullptr;
            if (key != nullptr) {
                drawn.push_back({key->path, draw_value(*key, draw)});
            } else {
                remove_named(refusal.what(), drawn);
            }
        }
    }
}

}  // namespace

std::vector<KeyDeclaration> drawable_keys(const std::filesystem::path& plugin) {
    const ConfigFile description = ConfigFile::description();
    read_system_settings(description);
    std::vector<KeyDeclaration> keys = description.declarations();
    std::erase_if(keys, [](const KeyDeclaration& key) { return !drawable(key); });
    if (!plugin.empty()) declare_plugin(plugin, keys);
    return keys;
}

DrawnKeys draw_keys(const std::vector<KeyDeclaration>& keys, RandomStream& draw) {
    DrawnKeys drawn = short_session(draw);
    draw_codec(keys, drawn, draw);
    draw_controller(keys, drawn, draw);
    std::vector<std::string> groups;
    for (const KeyDeclaration& key : keys) {
        const std::string group = group_of(key.path);
        if (std::find(groups.begin(), groups.end(), group) == groups.end()) groups.push_back(group);
    }
    for (std::uint32_t left = draw.below(kMostKeys); left-- > 0;) {
        const std::string& group = groups[draw.below(static_cast<std::uint32_t>(groups.size()))];
        std::vector<const KeyDeclaration*> of_group;
        for (const KeyDeclaration& key : keys)
            if (group_of(key.path) == group) of_group.push_back(&key);
        const KeyDeclaration& key = *of_group[draw.below(static_cast<std::uint32_t>(of_group.size()))];
        if (!has_key(drawn, key.path)) drawn.push_back({key.path, draw_value(key, draw)});
    }
    make_valid(drawn, keys, draw);
    return drawn;
}

std::string keys_text(const DrawnKeys& keys) {
    std::string text;
    for (const Line& line : lines_of(keys)) text += line.text + "\n";
    return text;
}

SystemSettings settings_of(DrawnKeys& keys) {
    for (;;) {
        try {
            return read(keys);
        } catch (const Error& refusal) {
            remove_named(refusal.what(), keys);
        }
    }
}

}  // namespace thimble
