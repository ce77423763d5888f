#include "common/config.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include "common/error.hpp"
#include "common/nearest_name.hpp"

namespace thimble {

struct ConfigFile::Impl {
    std::string name;
    std::filesystem::path folder;
    toml::table root;
    mutable std::set<std::string> known;  // dotted paths that a reader asked for
    mutable std::set<std::string> used;   // names of files
    bool notes = false;                   // note_declarations()
    mutable std::map<std::string, KeyDeclaration> declared;
};

namespace {

std::string join(std::string_view path, std::string_view key) {
    return path.empty() ? std::string(key) : fmt::format("{}.{}", path, key);
}

[[noreturn]] void refuse(const std::string& name, const toml::source_position& at, const std::string& why) {
    if (at.line == 0) throw Error(ExitCode::kUsage, fmt::format("{}: {}", name, why));
    throw Error(ExitCode::kUsage, fmt::format("{}:{}:{}: {}", name, at.line, at.column, why));
}

std::string type_name(const toml::node& node) {
    std::ostringstream text;
    text << node.type();
    return text.str();
}

// Keys of a file that no reader asked for.
class UnknownKeys {
  public:
    UnknownKeys(const std::string& file, const std::set<std::string>& known) : file_(file), known_(known) {}

    void refuse_entry(const std::string& path, std::string_view key, const toml::node& node) const {
        const std::string full = join(path, key);
        // A quoted key may hold a dot or a bracket, but none of ours does: it must not pass for a key in a
        // table.
        if (key.find_first_of(".[") == std::string_view::npos && known_.count(full) != 0) {
            return refuse_within(full, node);
        }
        refuse(file_, node.source().begin,
               fmt::format("unknown {} '{}': {}check the spelling, or remove it",
                           path.empty() ? "table or key" : "key", full, advice(path, key)));
    }

  private:
    std::string advice(const std::string& path, std::string_view key) const {
        const std::string beside = path.empty() ? "" : path + ".";
        std::vector<std::string> names;
        for (const std::string& known : known_) {
            if (!known.starts_with(beside) || known.find('.', beside.size()) != std::string::npos) continue;
            names.push_back(known.substr(beside.size()));
        }
        const std::string meant = nearest_name(key, names);
        return meant.empty() ? "" : fmt::format("did you mean '{}'? Otherwise ", meant);
    }

    void refuse_within(const std::string& path, const toml::node& node) const {
        if (const toml::table* inner = node.as_table()) {
            for (const auto& [key, value] : *inner) refuse_entry(path, key.str(), value);
        }
        if (const toml::array* list = node.as_array()) {
            for (std::size_t i = 0; i < list->size(); ++i) {
                refuse_within(fmt::format("{}[{}]", path, i), (*list)[i]);
            }
        }
    }

    const std::string& file_;
    const std::set<std::string>& known_;
};

}  // namespace

ConfigFile::ConfigFile(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ConfigFile::~ConfigFile() = default;
ConfigFile::ConfigFile(ConfigFile&&) noexcept = default;
ConfigFile& ConfigFile::operator=(ConfigFile&&) noexcept = default;

ConfigFile ConfigFile::load(const std::filesystem::path& path) {
    // A folder opens as a stream, too, and then throws when it is read.
    std::ifstream stream(path, std::ios::binary);
    if (!stream.is_open() || std::filesystem::is_directory(path)) {
        throw Error(ExitCode::kUsage,
                    fmt::format("{}: cannot read this configuration file; does it exist?", path.string()));
    }
    const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    ConfigFile file = parse(text, path.string());
    file.impl_->folder = path.parent_path();
    return file;
}

ConfigFile ConfigFile::parse(std::string_view text, std::string_view name) {
    auto impl = std::make_unique<Impl>();
    impl->name = name;
    try {
        impl->root = toml::parse(text);
    } catch (const toml::parse_error& error) {
        refuse(impl->name, error.source().begin, fmt::format("not TOML: {}", error.description()));
    }
    return ConfigFile(std::move(impl));
}

ConfigFile ConfigFile::empty() {
    auto impl = std::make_unique<Impl>();
    impl->name = "defaults";
    return ConfigFile(std::move(impl));
}

void ConfigFile::set(std::string_view dotted_key, double value) {
    toml::table* table = &impl_->root;
    std::string_view rest = dotted_key;
    for (std::size_t dot = rest.find('.'); dot != std::string_view::npos; dot = rest.find('.')) {
        const std::string_view name = rest.substr(0, dot);
        rest.remove_prefix(dot + 1);
        if (!table->contains(name)) table->insert(name, toml::table{});
        table = table->get(name)->as_table();
        if (table == nullptr) {
            refuse(impl_->name, {}, fmt::format("'{}': '{}' is no table", dotted_key, name));
        }
    }
    if (rest.empty()) refuse(impl_->name, {}, fmt::format("'{}' names no key", dotted_key));
    table->insert_or_assign(rest, value);
}

ConfigTable ConfigFile::root() const { return {this, ""}; }

const std::filesystem::path& ConfigFile::folder() const { return impl_->folder; }

void ConfigFile::uses(std::string_view name) const { impl_->used.emplace(name); }

const std::set<std::string>& ConfigFile::used_files() const { return impl_->used; }

void ConfigFile::note_declarations() { impl_->notes = true; }

const std::map<std::string, KeyDeclaration>& ConfigFile::declarations() const { return impl_->declared; }

void ConfigFile::finish(const std::vector<std::string_view>& elsewhere) const {
    const UnknownKeys unknown(impl_->name, impl_->known);
    for (const auto& [key, node] : impl_->root) {
        if (std::find(elsewhere.begin(), elsewhere.end(), key.str()) == elsewhere.end()) {
            unknown.refuse_entry("", key.str(), node);
        }
    }
}

// One key of the file: its node (null where absent), its dotted path, and how to refuse it.
struct ConfigTable::Found {
    const toml::node* node;
    std::string path;
    const std::string* file;

    [[noreturn]] void refuse(const std::string& why) const {
        thimble::refuse(*file, node == nullptr ? toml::source_position{} : node->source().begin,
                        fmt::format("'{}' {}", path, why));
    }
};

ConfigTable::Found ConfigTable::find(std::string_view key) const {
    const ConfigFile::Impl& file = *file_->impl_;
    Found found{nullptr, join(path_, key), &file.name};
    found.node = file.root.at_path(found.path).node();
    file.known.insert(found.path);
    return found;
}

void ConfigTable::declare(std::string_view key, std::string_view type, std::string fallback,
                          std::string range, std::vector<std::string> choices) const {
    const ConfigFile::Impl& file = *file_->impl_;
    if (!file.notes) return;
    KeyDeclaration& noted = file.declared[join(path_, key)];
    if (noted.type.find(type) == std::string::npos) {
        noted.type += fmt::format("{}{}", noted.type.empty() ? "" : " or ", type);
    }
    if (!fallback.empty()) noted.fallback = std::move(fallback);
    if (!range.empty()) noted.range = std::move(range);
    if (!choices.empty()) noted.choices = std::move(choices);
}

bool ConfigTable::has(std::string_view key) const {
    return file_->impl_->root.at_path(join(path_, key)).node() != nullptr;
}

bool ConfigTable::is_text(std::string_view key) const {
    const Found found = find(key);
    declare(key, "text");
    return found.node != nullptr && found.node->is_string();
}

bool ConfigTable::is_table(std::string_view key) const {
    const Found found = find(key);
    declare(key, "table");
    return found.node != nullptr && found.node->is_table();
}

ConfigTable ConfigTable::table(std::string_view key) const {
    const Found found = find(key);
    declare(key, "table");
    if (found.node != nullptr && !found.node->is_table()) {
        found.refuse(fmt::format("must be a table, [{}]", found.path));
    }
    return {file_, found.path};
}

std::vector<ConfigTable> ConfigTable::tables(std::string_view key) const {
    const Found found = find(key);
    declare(key, "tables");
    if (found.node == nullptr) return {};
    if (found.node->is_table()) return {{file_, found.path}};
    const toml::array* list = found.node->as_array();
    if (list == nullptr || !list->is_homogeneous<toml::table>()) {
        found.refuse(fmt::format("must be a table, [{0}], or several, [[{0}]]", found.path));
    }
    std::vector<ConfigTable> all;
    for (std::size_t i = 0; i < list->size(); ++i) {
        all.push_back({file_, fmt::format("{}[{}]", found.path, i)});
    }
    return all;
}

double ConfigTable::number(std::string_view key, double fallback, double low, double high) const {
    const Found found = find(key);
    declare(key, "number", fmt::format("{}", fallback), fmt::format("{} to {}", low, high));
    if (found.node == nullptr) return fallback;
    const auto value = found.node->value<double>();
    if (!found.node->is_number() || !value) {
        found.refuse(fmt::format("must be a number, not a {}", type_name(*found.node)));
    }
    if (!std::isfinite(*value) || *value < low || *value > high) {
        found.refuse(fmt::format("is {}, but must lie between {} and {}", *value, low, high));
    }
    return *value;
}

std::int64_t ConfigTable::integer(std::string_view key, std::int64_t fallback, std::int64_t low,
                                  std::int64_t high) const {
    const Found found = find(key);
    declare(key, "whole number", fmt::format("{}", fallback), fmt::format("{} to {}", low, high));
    if (found.node == nullptr) return fallback;
    if (!found.node->is_integer()) {
        found.refuse(fmt::format("must be a whole number, not a {}", type_name(*found.node)));
    }
    const std::int64_t value = found.node->as_integer()->get();
    if (value < low || value > high) {
        found.refuse(fmt::format("is {}, but must lie between {} and {}", value, low, high));
    }
    return value;
}

bool ConfigTable::boolean(std::string_view key, bool fallback) const {
    const Found found = find(key);
    declare(key, "true or false", fmt::format("{}", fallback));
    if (found.node == nullptr) return fallback;
    if (!found.node->is_boolean()) {
        found.refuse("must be true or false");
    }
    return found.node->as_boolean()->get();
}

std::string ConfigTable::text(std::string_view key, std::string_view fallback) const {
    const Found found = find(key);
    declare(key, "text", fallback.empty() ? "" : fmt::format("\"{}\"", fallback));
    if (found.node == nullptr) return std::string(fallback);
    if (!found.node->is_string()) {
        found.refuse("must be text in quotes");
    }
    return found.node->as_string()->get();
}

std::size_t ConfigTable::choice(std::string_view key, std::size_t fallback,
                                const std::vector<std::string_view>& choices) const {
    const std::string value = text(key, choices.at(fallback));
    declare(key, "text", {}, {}, {choices.begin(), choices.end()});
    const auto found = std::find(choices.begin(), choices.end(), value);
    if (found == choices.end()) {
        fail(key, fmt::format("is \"{}\", but must be one of {}", value, fmt::join(choices, ", ")));
    }
    return static_cast<std::size_t>(found - choices.begin());
}

Duration ConfigTable::seconds(std::string_view key, Duration fallback, Duration low, Duration high) const {
    return from_seconds(number(key, to_seconds(fallback), to_seconds(low), to_seconds(high)));
}

std::vector<double> ConfigTable::numbers(std::string_view key, const std::vector<double>& fallback,
                                         double low, double high) const {
    const Found found = find(key);
    declare(key, "list of numbers", fmt::format("{}", fallback), fmt::format("{} to {}", low, high));
    if (found.node == nullptr) return fallback;
    const toml::array* array = found.node->as_array();
    if (array == nullptr) found.refuse("must be a list, [1, 2]");
    std::vector<double> values;
    for (const toml::node& element : *array) {
        const auto value = element.value<double>();
        if (!element.is_number() || !value || !std::isfinite(*value) || *value < low || *value > high) {
            found.refuse(fmt::format("must hold numbers between {} and {}", low, high));
        }
        values.push_back(*value);
    }
    return values;
}

std::vector<std::string> ConfigTable::texts(std::string_view key,
                                            const std::vector<std::string>& fallback) const {
    const Found found = find(key);
    declare(key, "list of texts", fmt::format("{}", fallback));
    if (found.node == nullptr) return fallback;
    const toml::array* array = found.node->as_array();
    if (array == nullptr) found.refuse("must be a list of texts");
    std::vector<std::string> values;
    for (const toml::node& element : *array) {
        if (!element.is_string()) {
            found.refuse("must hold texts in quotes");
        }
        values.push_back(element.as_string()->get());
    }
    return values;
}

void ConfigTable::fail(std::string_view key, std::string_view why) const {
    const Found found = find(key);
    found.refuse(std::string(why));
}

}  // namespace thimble
