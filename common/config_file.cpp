#include <algorithm>
#include <fstream>
#include <map>

#include <fmt/ranges.h>

#include "common/config_impl.hpp"
#include "common/nearest_name.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

constexpr std::size_t kMostMistakes = 50;
constexpr std::size_t kLargestFile = std::size_t{1} << 20U;  // bytes
constexpr int kMostDots =
    64;  // of a line, between names: each dot is a table in a table, and they end one within the other

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// True for a dot inside a decimal number, or beside another dot as in "...".
bool joins_no_names(std::string_view line, std::size_t dot) {
    const auto at = [line](std::size_t i) { return i < line.size() ? line[i] : ' '; };
    std::size_t low = dot, high = dot + 1;
    while (low > 0 && is_digit(line[low - 1])) --low;
    while (is_digit(at(high))) ++high;
    const bool decimal = low < dot && high > dot + 1 && (low == 0 || line[low - 1] != '.') && at(high) != '.';
    return decimal || at(dot + 1) == '.' || (dot > 0 && line[dot - 1] == '.');
}

// toml++ limits how deep values lie within values, but not how many names a key has.
void refuse_long_keys(std::string_view text, std::string_view name) {
    for (std::uint32_t number = 1; !text.empty(); ++number) {
        const std::string_view line = take_until(text, '\n');
        int dots = 0;
        for (std::size_t dot = line.find('.'); dot != std::string_view::npos; dot = line.find('.', dot + 1))
            if (!joins_no_names(line, dot) && ++dots > kMostDots)
                throw Error(ExitCode::kUsage,
                            "{}:{}:{}: this line joins more than {} names by dots; no key has so many", name,
                            number, dot + 1, kMostDots);
    }
}

bool in_a_word(char c) {
    return c == '_' || (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
}

bool has_word(std::string_view text, std::string_view word) {
    for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
        const std::size_t end = at + word.size();
        if ((at == 0 || !in_a_word(text[at - 1])) && (end == text.size() || !in_a_word(text[end])))
            return true;
    }
    return false;
}

// All that is wrong with a file, each key once.
class Mistakes {
  public:
    explicit Mistakes(std::string file) : file_(std::move(file)) {}

    std::size_t count() const { return found_.size(); }

    void add(const KeyError& error) {
        // A check of several keys that names a wrong one follows from that.
        const bool follows = error.fault == KeyFault::kWithOthers &&
                             std::any_of(keys_.begin(), keys_.end(), [&error](const std::string& key) {
                                 return has_word(error.reason(), key);
                             });
        const std::string table = error.path.substr(0, error.path.rfind('.'));
        // A check of keys beside a file that cannot be read, which may have made them right.
        const bool unsure = error.fault == KeyFault::kWithOthers && half_read_.count(table) != 0;
        if (error.why.empty()) half_read_.insert(table);
        if (!paths_.insert(error.path).second || follows || unsure) return;
        keys_.insert(error.path.substr(error.path.rfind('.') + 1));
        if (keys_.count("delays_s") != 0) keys_.insert("delay_s");  // which it sets
        const Error& words = error;                                 // without what only this class needs
        found_.push_back({words, error.at});
    }
    void add(const Error& error) { found_.push_back({error, {}}); }

    // One as it is, several below a line of their own, in the order of the file.
    Error all() {
        if (found_.size() == 1) return found_.front().error;
        const auto line = [](const Mistake& one) { return one.at.line == 0 ? UINT32_MAX : one.at.line; };
        std::stable_sort(found_.begin(), found_.end(), [line](const Mistake& a, const Mistake& b) {
            return std::pair(line(a), a.at.column) < std::pair(line(b), b.at.column);
        });
        std::string text = fmt::format("{} has {} errors:", file_, found_.size());
        for (std::size_t i = 0; i < std::min(found_.size(), kMostMistakes); ++i)
            text += "\n" + line_of(found_[i]);
        if (found_.size() > kMostMistakes)
            text += fmt::format("\n... and {} more", found_.size() - kMostMistakes);
        return {ExitCode::kUsage, text};
    }

  private:
    struct Mistake {
        Error error;
        toml::source_position at;
    };
    // A mistake in another file has the place of its name in this one.
    std::string line_of(const Mistake& one) const {
        std::string words = one.error.what();
        if (words.starts_with(file_) || one.at.line == 0) return words;
        return fmt::format("{}:{}:{}: {}", file_, one.at.line, one.at.column, words);
    }
    std::string file_;
    std::vector<Mistake> found_{};
    std::set<std::string> paths_{}, keys_{}, half_read_{};
};

// Keys of a file that no reader asked for.
class UnknownKeys {
  public:
    UnknownKeys(const std::string& file, const std::set<std::string>& known, Mistakes& mistakes)
        : file_(file), known_(known), mistakes_(mistakes) {}

    void judge(const std::string& path, std::string_view key, const toml::node& node) const {
        const std::string full = join(path, key);
        // A quoted key may hold a dot or a bracket, but none of ours does: it must not pass for a key in a
        // table.
        if (key.find_first_of(".[") == std::string_view::npos && known_.count(full) != 0) {
            return judge_within(full, node);
        }
        mistakes_.add(KeyError(file_, full, node.source().begin,
                               fmt::format("unknown {} '{}': {}check the spelling, or remove it",
                                           path.empty() ? "table or key" : "key", full, advice(path, key)),
                               KeyFault::kOwn));
    }

  private:
    // Names of keys, each with the tables that have such a key. Lists have no names that a reader of the advice could write.
    std::map<std::string, std::vector<std::string>> tables_of_keys() const {
        std::map<std::string, std::vector<std::string>> tables;
        for (const std::string& path : known_) {
            const std::size_t dot = path.rfind('.');
            const std::string table = dot == std::string::npos ? "" : path.substr(0, dot);
            if (table.find('[') == std::string::npos) tables[path.substr(dot + 1)].push_back(table);
        }
        return tables;
    }

    // "did you mean 'stiffness_N_per_m' in [fixture]? Otherwise ": a key of the same table first, and one of this name elsewhere.
    std::string advice(const std::string& path, std::string_view key) const {
        std::vector<std::string> beside, all, meant;
        const auto tables = tables_of_keys();
        for (const auto& [name, homes] : tables) {
            all.push_back(name);
            if (std::find(homes.begin(), homes.end(), path) != homes.end()) beside.push_back(name);
        }
        const std::string near = nearest_name(key, beside);
        if (!near.empty()) meant.push_back(fmt::format("'{}'", near));
        const bool elsewhere = tables.count(std::string(key)) != 0;
        const std::string other = elsewhere ? std::string(key) : near.empty() ? nearest_name(key, all) : "";
        if (!other.empty()) {
            const std::string homes = fmt::format("[{}]", fmt::join(tables.at(other), "] or ["));
            meant.push_back(homes == "[]" ? fmt::format("[{}]", other)
                                          : fmt::format("'{}' in {}", other, homes));
        }
        return meant.empty() ? "" : fmt::format("did you mean {}? Otherwise ", fmt::join(meant, ", or "));
    }

    void judge_within(const std::string& path, const toml::node& node) const {
        if (const toml::table* inner = node.as_table()) {
            for (const auto& [key, value] : *inner) judge(path, key.str(), value);
        }
        if (const toml::array* list = node.as_array()) {
            for (std::size_t i = 0; i < list->size(); ++i) {
                judge_within(fmt::format("{}[{}]", path, i), (*list)[i]);
            }
        }
    }

    const std::string& file_;
    const std::set<std::string>& known_;
    Mistakes& mistakes_;
};

}  // namespace

toml::source_position ConfigFile::Impl::place_of(std::string_view path) const {
    for (;;) {
        if (const toml::node* node = root.at_path(path).node()) return node->source().begin;
        const std::size_t dot = path.rfind('.');
        if (dot == std::string_view::npos) return {};
        path = path.substr(0, dot);
    }
}

bool ConfigFile::Impl::forget(const KeyError& error) {
    std::string path = error.path;
    for (;;) {
        if (path.ends_with(']'))
            path.resize(path.rfind('['));  // a list goes whole: its numbers must not move
        const std::size_t dot = path.rfind('.');
        const std::string key = path.substr(dot + 1);
        path.resize(dot == std::string::npos ? 0 : dot);
        toml::table* table = path.empty() ? &root : root.at_path(path).as_table();
        if (table != nullptr && table->erase(key) > 0) return true;
        if (table != nullptr && error.path.size() == join(path, key).size()) {
            for (const auto& [beside, node] : *table)
                if (has_word(error.reason(), beside.str())) return table->erase(beside) > 0;
        }
        if (path.empty()) return false;
    }
}

ConfigFile::ConfigFile(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ConfigFile::~ConfigFile() = default;
ConfigFile::ConfigFile(ConfigFile&&) noexcept = default;
ConfigFile& ConfigFile::operator=(ConfigFile&&) noexcept = default;

ConfigFile ConfigFile::load(const std::filesystem::path& path) {
    refuse_folder(path);
    std::ifstream stream(path, std::ios::binary);
    if (!stream.is_open())
        throw Error(ExitCode::kUsage, "{}: cannot read this configuration file; does it exist?",
                    path.string());
    // A device such as /dev/zero has no end.
    const std::string text = read_to_end(stream, path, kLargestFile);
    if (text.size() > kLargestFile)
        throw Error(ExitCode::kUsage, "{}: has more than {} bytes; is it a configuration file?",
                    path.string(), kLargestFile);
    ConfigFile file = parse(text, path.string());
    file.impl_->folder = path.parent_path();
    return file;
}

ConfigFile ConfigFile::parse(std::string_view text, std::string_view name) {
    auto impl = std::make_unique<Impl>();
    impl->name = name;
    refuse_long_keys(text, name);
    try {
        impl->root = toml::parse(text);
    } catch (const toml::parse_error& error) {
        const toml::source_position at = error.source().begin;
        throw Error(ExitCode::kUsage, "{}:{}:{}: not TOML: {}", name, at.line, at.column,
                    error.description());
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

std::string ConfigFile::all_values(const std::function<void()>& read) const {
    impl_->describes = true;
    impl_->declared.clear();
    read();
    impl_->describes = false;
    std::string text;
    for (const KeyDeclaration& key : impl_->declared) {
        const toml::node* node = impl_->root.at_path(key.path).node();
        const bool is_table = key.types.size() == 1 && key.types[0].starts_with("table");
        if (is_table || key.path.find('[') != std::string::npos) continue;
        if (node == nullptr && key.fallback.empty()) continue;
        text += fmt::format("{} = {}\n", key.path, node != nullptr ? as_written(*node) : key.fallback);
    }
    return text;
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
            throw Error(ExitCode::kUsage, "{}: '{}': '{}' is not a table", impl_->name, dotted_key, name);
        }
    }
    if (rest.empty()) throw Error(ExitCode::kUsage, "{}: '{}' is not a key", impl_->name, dotted_key);
    table->insert_or_assign(rest, value);
}

ConfigTable ConfigFile::root() const { return {this, ""}; }

const std::filesystem::path& ConfigFile::folder() const { return impl_->folder; }

void ConfigFile::uses(std::string_view name) const { impl_->used.emplace(name); }

const std::set<std::string>& ConfigFile::used_files() const { return impl_->used; }

const std::vector<KeyDeclaration>& ConfigFile::declarations() const { return impl_->declared; }

// Forgets a wrong key and reads the file again as if it lacked it. So each reader says all it has to say, and sees a good file in the end.
void ConfigFile::read_all(const std::function<void()>& read,
                          const std::vector<std::string_view>& elsewhere) const {
    Mistakes mistakes(impl_->name);
    bool whole = false;
    while (!whole && mistakes.count() < kMostMistakes) {
        try {
            read();
            whole = true;
        } catch (const KeyError& error) {
            mistakes.add(error);
            if (!impl_->forget(error)) break;
        } catch (const Error& error) {
            if (mistakes.count() == 0) throw;
            break;  // perhaps only since a key is missing now
        }
    }
    for (const auto& [key, node] : impl_->root) {
        if (!whole || std::find(elsewhere.begin(), elsewhere.end(), key.str()) != elsewhere.end()) continue;
        UnknownKeys(impl_->name, impl_->known, mistakes).judge("", key.str(), node);
    }
    if (mistakes.count() > 0) throw mistakes.all();
}

}  // namespace thimble
