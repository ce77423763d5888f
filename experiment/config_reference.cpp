#include "experiment/config_reference.hpp"

#include <array>
#include <set>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "experiment/system_settings.hpp"

namespace thimble {
namespace {

using Keys = std::map<std::string, KeyDeclaration>;

// What some keys are read beside, where choosing alone does not lead to them.
constexpr std::array<std::string_view, 8> kCompanions{
    "session = { subject = \"human\", participant = \"P01\" }",
    "netem.needle.timeline = [{ at_s = 1, loss = 0.1 }]",
    "netem.force.timeline = [{ at_s = 1, loss = 0.1 }]",
    "netem.needle = { loss = 0.01 }",
    "netem.force = { loss = 0.01 }",
    "netem.needle = { loss = { model = \"gilbert\", share = 0.01 } }",
    "netem.force = { loss = { model = \"gilbert\", share = 0.01 } }",
    "cutaneous.device = \"drives\""};

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
    Keys all() {
        ask("");
        for (const std::string_view text : kCompanions) ask(std::string(text));
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
                read_system_settings(file);
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

    Keys keys_;
    std::set<std::string> asked_;
    std::set<std::string> waiting_;
};

std::string table_of(const std::string& path) { return path.substr(0, path.rfind('.')); }

std::string what_it_may_be(const KeyDeclaration& declared) {
    if (declared.choices.empty()) return declared.range;
    return fmt::format("`\"{}\"`", fmt::join(declared.choices, "\"`, `\""));
}

std::string line_of(std::string_view key, const KeyDeclaration& declared) {
    return fmt::format("| `{}` | {} | {} | {} |\n", key, declared.type,
                       declared.fallback.empty() ? "" : fmt::format("`{}`", declared.fallback),
                       what_it_may_be(declared));
}

}  // namespace

Keys session_file_keys() { return Walk().all(); }

std::string keys_as_markdown(const Keys& keys) {
    std::map<std::string, std::string> tables;
    for (const auto& [path, declared] : keys) {
        if (path.find('.') == std::string::npos || declared.type == "table" || declared.type == "tables")
            continue;
        tables[table_of(path)] += line_of(path.substr(path.rfind('.') + 1), declared);
    }
    // Links and pages have the same keys several times over.
    std::map<std::string, std::vector<std::string>> same;
    for (const auto& [table, lines] : tables) same[lines].push_back(table);
    std::string text;
    for (const auto& [table, lines] : tables) {
        const std::vector<std::string>& together = same[lines];
        if (together.front() != table) continue;
        text += fmt::format("## [{}]\n\n| key | type | default | range |\n| --- | --- | --- | --- |\n{}\n",
                            fmt::join(together, "], ["), lines);
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
    return all.dump(2) + "\n";
}

}  // namespace thimble
