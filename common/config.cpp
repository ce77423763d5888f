#include "common/config.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
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
    bool describes = false;
    mutable std::vector<KeyDeclaration> declared;
};

namespace {

std::string join(std::string_view path, std::string_view key) {
    return path.empty() ? std::string(key) : fmt::format("{}.{}", path, key);
}

template <class... Values>
[[noreturn]] void refuse(const std::string& name, const toml::source_position& at,
                         fmt::format_string<Values...> why, Values&&... values) {
    const std::string text = fmt::format(why, std::forward<Values>(values)...);
    if (at.line == 0) throw Error(ExitCode::kUsage, "{}: {}", name, text);
    throw Error(ExitCode::kUsage, "{}:{}:{}: {}", name, at.line, at.column, text);
}

std::string type_name(const toml::node& node) {
    std::ostringstream text;
    text << node.type();
    return text.str();
}

template <class Value, class Limit>
void add_range(KeyDeclaration& noted, const std::optional<Value>& fallback, Limit low, Limit high) {
    // Twelve digits: a default that was computed is not exact.
    constexpr const char* kForm = std::is_same_v<Value, double> ? "{:.12g}" : "{}";
    if (fallback) noted.fallback = fmt::format(fmt::runtime(kForm), *fallback);
    noted.low = fmt::format("{}", low);
    noted.high = fmt::format("{}", high);
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
        refuse(file_, node.source().begin, "unknown {} '{}': {}check the spelling, or remove it",
               path.empty() ? "table or key" : "key", full, advice(path, key));
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
        throw Error(ExitCode::kUsage, "{}: cannot read this configuration file; does it exist?",
                    path.string());
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
        refuse(impl->name, error.source().begin, "not TOML: {}", error.description());
    }
    return ConfigFile(std::move(impl));
}

ConfigFile ConfigFile::empty() {
    auto impl = std::make_unique<Impl>();
    impl->name = "defaults";
    return ConfigFile(std::move(impl));
}

ConfigFile ConfigFile::description() {
    ConfigFile none = empty();
    none.impl_->describes = true;
    return none;
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
            refuse(impl_->name, {}, "'{}': '{}' is no table", dotted_key, name);
        }
    }
    if (rest.empty()) refuse(impl_->name, {}, "'{}' names no key", dotted_key);
    table->insert_or_assign(rest, value);
}

ConfigTable ConfigFile::root() const { return {this, ""}; }

const std::filesystem::path& ConfigFile::folder() const { return impl_->folder; }

void ConfigFile::uses(std::string_view name) const { impl_->used.emplace(name); }

const std::set<std::string>& ConfigFile::used_files() const { return impl_->used; }

const std::vector<KeyDeclaration>& ConfigFile::declarations() const { return impl_->declared; }

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

    template <class... Values>
    [[noreturn]] void refuse(fmt::format_string<Values...> why, Values&&... values) const {
        thimble::refuse(*file, node == nullptr ? toml::source_position{} : node->source().begin, "'{}' {}",
                        path, fmt::format(why, std::forward<Values>(values)...));
    }
};

// Where this reader says nothing of the key, the description of another reader stays.
KeyDeclaration& ConfigTable::declare(std::string_view key, std::string_view type,
                                     std::string_view help) const {
    std::vector<KeyDeclaration>& all = file_->impl_->declared;
    const std::string path = join(path_, key);
    const auto is_it = [&path](const KeyDeclaration& one) { return one.path == path; };
    auto found = std::find_if(all.begin(), all.end(), is_it);
    if (found == all.end()) found = all.insert(found, {path, {}, {}, {}, {}, {}, {}});
    KeyDeclaration& noted = *found;
    if (std::find(noted.types.begin(), noted.types.end(), type) == noted.types.end()) {
        noted.types.emplace_back(type);
    }
    if (help.empty()) return noted;
    noted.help = users_.empty() ? help : fmt::format("{}: {}", fmt::join(users_, ", "), help);
    return noted;
}

bool ConfigTable::describes() const { return file_->impl_->describes; }

ConfigTable::Found ConfigTable::find(std::string_view key) const {
    const ConfigFile::Impl& file = *file_->impl_;
    Found found{nullptr, join(path_, key), &file.name};
    found.node = file.root.at_path(found.path).node();
    file.known.insert(found.path);
    const bool used = users_.empty() || std::find(users_.begin(), users_.end(), chosen_) != users_.end();
    if (!used && found.node != nullptr) {
        found.refuse("has no effect with {} = \"{}\": remove it, or choose {}", chooser_, chosen_,
                     fmt::join(users_, " or "));
    }
    return found;
}

bool ConfigTable::has(std::string_view key) const {
    return file_->impl_->root.at_path(join(path_, key)).node() != nullptr;
}

bool ConfigTable::is_text(std::string_view key) const {
    if (describes()) declare(key, "text", "");
    const Found found = find(key);
    return found.node != nullptr && found.node->is_string();
}

ConfigTable ConfigTable::table(std::string_view key) const {
    if (describes()) declare(key, "table", "");
    const Found found = find(key);
    if (found.node != nullptr && !found.node->is_table()) {
        found.refuse("must be a table, [{}]", found.path);
    }
    return {file_, found.path};
}

std::optional<ConfigTable> ConfigTable::number_or_table(std::string_view key, double& value, double low,
                                                        double high, std::string_view help) const {
    const toml::node* node = file_->impl_->root.at_path(join(path_, key)).node();
    const bool is_table = node != nullptr && node->is_table();
    if (!is_table) read(key, value, low, high, help);
    if (is_table || describes()) return table(key);
    return std::nullopt;
}

std::vector<ConfigTable> ConfigTable::tables(std::string_view key,
                                             const std::function<void(const ConfigTable&)>& describe) const {
    const Found found = find(key);
    if (describes()) {
        declare(key, "tables", "");
        describe({file_, found.path + "[]"});
    }
    if (found.node == nullptr) return {};
    if (found.node->is_table()) return {{file_, found.path}};
    const toml::array* list = found.node->as_array();
    if (list == nullptr || !list->is_homogeneous<toml::table>()) {
        found.refuse("must be a table, [{0}], or several, [[{0}]]", found.path);
    }
    std::vector<ConfigTable> all;
    for (std::size_t i = 0; i < list->size(); ++i) {
        all.push_back({file_, fmt::format("{}[{}]", found.path, i)});
    }
    return all;
}

ConfigTable ConfigTable::only_with(std::string_view chooser, std::string_view chosen,
                                   std::vector<std::string_view> users) const {
    ConfigTable same = *this;
    same.chooser_ = chooser;
    same.chosen_ = chosen;
    same.users_ = std::move(users);
    return same;
}

// Comparisons that no NaN passes.
template <class Value>
void ConfigTable::read_limited(std::string_view key, std::string_view type, std::optional<Value>& value,
                               Value low, Value high, std::string_view help) const {
    if (describes()) add_range(declare(key, type, help), value, low, high);
    const Found found = find(key);
    if (found.node == nullptr) return;
    value = found.node->value<Value>();
    if (!value || !(std::is_integral_v<Value> ? found.node->is_integer() : found.node->is_number())) {
        found.refuse("must be a {}, not a {}", type, type_name(*found.node));
    }
    if (!(*value >= low && *value <= high)) {
        found.refuse("is {}, but must lie between {} and {}", *value, low, high);
    }
}

void ConfigTable::read(std::string_view key, std::optional<double>& value, double low, double high,
                       std::string_view help) const {
    read_limited(key, "number", value, low, high, help);
}

void ConfigTable::read(std::string_view key, double& value, double low, double high,
                       std::string_view help) const {
    std::optional<double> number = value;
    read(key, number, low, high, help);
    value = *number;
}

void ConfigTable::read(std::string_view key, Duration& value, double low_s, double high_s,
                       std::string_view help) const {
    double seconds = to_seconds(value);
    read(key, seconds, low_s, high_s, help);
    value = from_seconds(seconds);
}

std::int64_t ConfigTable::whole(std::string_view key, std::int64_t fallback, std::int64_t low,
                                std::int64_t high, std::string_view help) const {
    std::optional<std::int64_t> value = fallback;
    read_limited(key, "whole number", value, low, high, help);
    return *value;
}

void ConfigTable::read(std::string_view key, bool& value, std::string_view help) const {
    if (describes()) declare(key, "true or false", help).fallback = fmt::format("{}", value);
    const Found found = find(key);
    if (found.node == nullptr) return;
    if (!found.node->is_boolean()) found.refuse("must be true or false");
    value = found.node->as_boolean()->get();
}

void ConfigTable::read(std::string_view key, std::string& value, std::string_view help) const {
    if (describes()) {
        KeyDeclaration& noted = declare(key, "text", help);
        if (!value.empty()) noted.fallback = fmt::format("\"{}\"", value);
    }
    const Found found = find(key);
    if (found.node == nullptr) return;
    if (!found.node->is_string()) found.refuse("must be text in quotes");
    value = found.node->as_string()->get();
}

std::size_t ConfigTable::choice(std::string_view key, std::size_t fallback,
                                std::span<const std::string_view> names, std::string_view help) const {
    if (describes()) {
        KeyDeclaration& noted = declare(key, "text", help);
        noted.fallback = fmt::format("\"{}\"", names[fallback]);
        noted.choices.assign(names.begin(), names.end());
    }
    const Found found = find(key);
    if (found.node == nullptr) return fallback;
    if (!found.node->is_string()) found.refuse("must be text in quotes");
    const std::string& value = found.node->as_string()->get();
    const auto at = std::find(names.begin(), names.end(), value);
    if (at == names.end()) {
        found.refuse("is \"{}\", but must be one of {}", value, fmt::join(names, ", "));
    }
    return static_cast<std::size_t>(at - names.begin());
}

// `wants` and `each` say of a list and of its elements what they must be.
template <class Element, class Good>
void ConfigTable::read_list(std::string_view key, std::vector<Element>& values, std::string_view wants,
                            const std::string& each, const Good& good) const {
    const Found found = find(key);
    if (found.node == nullptr) return;
    const toml::array* array = found.node->as_array();
    if (array == nullptr) found.refuse("{}", wants);
    values.clear();
    for (const toml::node& element : *array) {
        const auto value = element.value<Element>();
        if (!value || !good(element, *value)) found.refuse("{}", each);
        values.push_back(*value);
    }
}

void ConfigTable::read(std::string_view key, std::vector<double>& values, double low, double high,
                       std::string_view help) const {
    if (describes()) add_range(declare(key, "list of numbers", help), std::optional(values), low, high);
    read_list(key, values, "must be a list, [1, 2]",
              fmt::format("must hold numbers between {} and {}", low, high),
              [&](const toml::node& node, double value) {
                  return node.is_number() && value >= low && value <= high;
              });
}

void ConfigTable::read(std::string_view key, std::vector<std::string>& values, std::string_view help) const {
    if (describes()) declare(key, "list of texts", help).fallback = fmt::format("{}", values);
    read_list(key, values, "must be a list of texts", "must hold texts in quotes",
              [](const toml::node& node, const std::string& /*value*/) { return node.is_string(); });
}

void ConfigTable::fail(std::string_view key, std::string_view why) const { find(key).refuse("{}", why); }

}  // namespace thimble
