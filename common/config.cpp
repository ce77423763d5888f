#include "common/config.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <fmt/ranges.h>

#include "common/config_impl.hpp"
#include "common/duration_text.hpp"

namespace thimble {

namespace {

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

}  // namespace

// One key of the file: its node (null where absent), its dotted path, and how to refuse it.
struct ConfigTable::Found {
    const toml::node* node;
    std::string path;
    const ConfigFile::Impl* file;

    [[noreturn]] void refuse_for(KeyFault fault, std::string_view why) const {
        throw KeyError(file->name, path, file->place_of(path), fmt::format("'{}' {}", path, why), fault);
    }
    template <class... Values>
    [[noreturn]] void refuse(fmt::format_string<Values...> why, Values&&... values) const {
        refuse_for(KeyFault::kOwn, fmt::format(why, std::forward<Values>(values)...));
    }
    // The value of this key or of one element of its list; seconds may be text with a unit. Nothing of what is no number.
    std::optional<double> number(const toml::node& value) const {
        if (!value.is_string() || !holds_seconds(path))
            return value.is_number() ? value.value<double>() : std::nullopt;
        const std::string& text = value.as_string()->get();
        const auto seconds = parse_duration(text);
        if (!seconds)
            refuse("is \"{}\": write seconds as a number, or a number with a unit ({}), as \"50ms\"", text,
                   kDurationUnits);
        return seconds;
    }
    // Refuses a value that is in range but probably a mistake, such as milliseconds in a key of seconds.
    void doubt(const toml::node& value) const {
        if (value.source().begin.line == 0) return;  // not of the file: ConfigFile::set()
        const std::string why =
            value.is_number() ? doubt_seconds(path.substr(path.rfind('.') + 1), *value.value<double>()) : "";
        if (!why.empty()) refuse("holds {}", why);
    }
};

// A description by another reader stays if this reader has none for the key.
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
    ConfigFile::Impl& file = *file_->impl_;
    Found found{nullptr, join(path_, key), &file};
    found.node = file.root.at_path(found.path).node();
    file.known.insert(found.path);
    const bool used = users_.empty() || std::find(users_.begin(), users_.end(), chosen_) != users_.end();
    if (!used && found.node != nullptr) {
        found.refuse_for(KeyFault::kWithOthers,
                         fmt::format("has no effect with {} = \"{}\": remove it, or choose {}", chooser_,
                                     chosen_, fmt::join(users_, " or ")));
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
    if (is_table || (describes() && node == nullptr)) return table(key);
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
void ConfigTable::read(std::string_view key, std::optional<double>& value, double low, double high,
                       std::string_view help) const {
    if (describes()) add_range(declare(key, "number", help), value, low, high);
    const Found found = find(key);
    if (found.node == nullptr) return;
    value = found.number(*found.node);
    if (!value) found.refuse("must be a number, not a {}", type_name(*found.node));
    if (!(*value >= low && *value <= high)) {
        found.refuse("is {}, but must lie between {} and {}{}", *value, low, high,
                     found.node->is_number() ? meant_milliseconds(key, *value, low, high) : "");
    }
    found.doubt(*found.node);
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
    if (describes()) add_range(declare(key, "whole number", help), std::optional(fallback), low, high);
    const Found found = find(key);
    if (found.node == nullptr) return fallback;
    if (!found.node->is_integer()) found.refuse("must be a whole number, not a {}", type_name(*found.node));
    const std::int64_t value = found.node->as_integer()->get();
    if (value < low || value > high) found.refuse("is {}, but must lie between {} and {}", value, low, high);
    return value;
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

void ConfigTable::read(std::string_view key, std::vector<double>& values, double low, double high,
                       std::string_view help) const {
    if (describes()) add_range(declare(key, "list of numbers", help), std::optional(values), low, high);
    const Found found = find(key);
    if (found.node == nullptr) return;
    if (!found.node->is_array()) found.refuse("must be a list, [1, 2]");
    values.clear();
    std::vector<std::string> wrong;
    std::string meant;
    for (const toml::node& element : *found.node->as_array()) {
        values.push_back(found.number(element).value_or(std::nan("")));
        if (values.back() >= low && values.back() <= high) continue;
        wrong.push_back(as_written(element));
        if (meant.empty() && element.is_number()) meant = meant_milliseconds(key, values.back(), low, high);
    }
    if (!wrong.empty())
        found.refuse("holds {}, but must hold numbers between {} and {}{}", fmt::join(wrong, ", "), low, high,
                     meant);
    for (const toml::node& element : *found.node->as_array()) found.doubt(element);
}

void ConfigTable::read(std::string_view key, std::vector<std::string>& values, std::string_view help) const {
    if (describes()) declare(key, "list of texts", help).fallback = fmt::format("{}", values);
    const Found found = find(key);
    if (found.node == nullptr) return;
    if (!found.node->is_array()) found.refuse("must be a list of texts");
    values.clear();
    for (const toml::node& element : *found.node->as_array()) {
        if (!element.is_string()) found.refuse("must hold texts in quotes");
        values.push_back(element.as_string()->get());
    }
}

void ConfigTable::fail(std::string_view key, std::string_view why) const {
    find(key).refuse_for(KeyFault::kWithOthers, why);
}

void ConfigTable::load(std::string_view key, const std::function<void()>& read) const {
    try {
        read();
    } catch (const Error& error) {
        const Found found = find(key);
        throw KeyError(error, found.path, file_->impl_->place_of(found.path));
    }
}

}  // namespace thimble
