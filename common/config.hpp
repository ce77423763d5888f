// Configuration files people write: TOML, read strictly. Unknown keys, wrong types and values out of range
// end the program with file, line and what is allowed (exit code 2), all of a file at once.
#pragma once

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "common/time.hpp"

namespace thimble {

class ConfigFile;

// The reader's description of a key, as text for people and for schemas.
struct KeyDeclaration {
    std::string path;  // dotted; of an entry of several tables "table[].key"
    std::vector<std::string>
        types;              // one or more of "number", "whole number", "text", "table", "tables", ...
    std::string fallback;   // as a file would write it; empty: none
    std::string low, high;  // empty: any
    std::vector<std::string> choices;  // all that a text may be; empty: not limited
    std::string help;                  // the key's meaning, in a line
};

// One table of the file. read() describes a key and takes its value: a key that the file lacks leaves `value` as it is, which is
// the default. A key that ends in _s may also be text with a unit, "50ms". Copyable handle; lives no longer than its ConfigFile.
class ConfigTable {
  public:
    void read(std::string_view key, double& value, double low, double high, std::string_view help) const;
    // A key without a default.
    void read(std::string_view key, std::optional<double>& value, double low, double high,
              std::string_view help) const;
    // Seconds in the file (a key ending in _s), nanoseconds in the program.
    void read(std::string_view key, Duration& value, double low_s, double high_s,
              std::string_view help) const;
    void read(std::string_view key, std::vector<double>& values, double low, double high,
              std::string_view help) const;
    void read(std::string_view key, bool& value, std::string_view help) const;
    void read(std::string_view key, std::string& value, std::string_view help) const;
    void read(std::string_view key, std::vector<std::string>& values, std::string_view help) const;
    template <std::integral Whole>
    void read(std::string_view key, Whole& value, std::int64_t low, std::int64_t high,
              std::string_view help) const {
        value = static_cast<Whole>(whole(key, static_cast<std::int64_t>(value), low, high, help));
    }
    // The index of a text in `names`, as an enumerator or a number.
    template <class Choice>
    requires std::is_enum_v<Choice> || std::integral<Choice>
    void read(std::string_view key, Choice& value, std::span<const std::string_view> names,
              std::string_view help) const {
        value = static_cast<Choice>(choice(key, static_cast<std::size_t>(value), names, help));
    }
    template <class Choice>
    void read(std::string_view key, Choice& value, std::initializer_list<std::string_view> names,
              std::string_view help) const {
        read(key, value, std::span(names.begin(), names.size()), help);
    }
    bool has(std::string_view key) const;
    // Of a key that may be text or something else; false where it is absent.
    bool is_text(std::string_view key) const;
    ConfigTable table(std::string_view key) const;
    // For a key that may be a number or a table: the table, if it is one. description() lists both.
    std::optional<ConfigTable> number_or_table(std::string_view key, double& value, double low, double high,
                                               std::string_view help) const;
    // One table [key] or an array of tables [[key]], in the order of the file; none if absent. `describe` reads the keys of one:
    // for a description, where it gets an entry that is in no file.
    std::vector<ConfigTable> tables(std::string_view key,
                                    const std::function<void(const ConfigTable&)>& describe) const;
    // The same table for keys that have an effect only where `chooser` is one of `users`. It is `chosen`: if that is none of them, a
    // key that is there is refused.
    ConfigTable only_with(std::string_view chooser, std::string_view chosen,
                          std::vector<std::string_view> users) const;
    // `read` reads another file, which this key names. An error there is reported at this key.
    void load(std::string_view key, const std::function<void()>& read) const;
    // An Error (usage) that names file, line and key; for checks that span several keys. It stays unsaid if it names a key that is
    // itself wrong.
    [[noreturn]] void fail(std::string_view key, std::string_view why) const;
    template <class First, class... More>
    [[noreturn]] void fail(std::string_view key, fmt::format_string<First, More...> why, First&& first,
                           More&&... more) const {
        fail(key, fmt::format(why, std::forward<First>(first), std::forward<More>(more)...));
    }

  private:
    friend class ConfigFile;
    struct Found;
    ConfigTable(const ConfigFile* file, std::string path) : file_(file), path_(std::move(path)) {}
    Found find(std::string_view key) const;
    KeyDeclaration& declare(std::string_view key, std::string_view type, std::string_view help) const;
    bool describes() const;
    std::int64_t whole(std::string_view key, std::int64_t fallback, std::int64_t low, std::int64_t high,
                       std::string_view help) const;
    std::size_t choice(std::string_view key, std::size_t fallback, std::span<const std::string_view> names,
                       std::string_view help) const;

    const ConfigFile* file_;
    std::string path_;  // dotted, "" for the root
    std::string_view chooser_{}, chosen_{};
    std::vector<std::string_view> users_{};  // empty: every choice
};

class ConfigFile {
  public:
    // Throws Error (usage) if the file is missing or is not TOML.
    static ConfigFile load(const std::filesystem::path& path);
    static ConfigFile parse(std::string_view text, std::string_view name);
    static ConfigFile empty();
    // No file at all: readers of its tables describe their keys.
    static ConfigFile description();
    ~ConfigFile();
    ConfigFile(ConfigFile&&) noexcept;
    ConfigFile& operator=(ConfigFile&&) noexcept;

    // The same as if the file said `value` under this dotted key ("operator.criterion_N"). Throws Error (usage)
    // if a table on the way is none. Positions in later messages are then those of what is left of the file.
    void set(std::string_view dotted_key, double value);

    ConfigTable root() const;
    // Where the file lies, which relative paths in it start from; empty for text that was no file.
    const std::filesystem::path& folder() const;
    // For readers of keys that name files: `name`, as written, was read from beside this file. A copy of the file on
    // another machine needs these too.
    void uses(std::string_view name) const;
    const std::set<std::string>& used_files() const;
    ConfigTable table(std::string_view key) const { return root().table(key); }
    // Every key that `read` asks for with its value, "table.key = value" as a file would write it, a line each: those of this file, and
    // the defaults of the rest. Keys of lists of tables are left out. `read` reads this file, which has no mistakes.
    std::string all_values(const std::function<void()>& read) const;
    // Of description(): every key that was read, in the order of reading.
    const std::vector<KeyDeclaration>& declarations() const;
    // Calls `read`, which reads this file, and throws all that is wrong with it as one Error (usage): what readers refuse and keys that
    // none of them asked for. For that it calls `read` again, as if the file lacked a key that was refused. Tables in `elsewhere` belong
    // to other programs of the session: their keys are theirs to check.
    void read_all(const std::function<void()>& read,
                  const std::vector<std::string_view>& elsewhere = {}) const;
    // Of a file that has been read: refuses only the keys that no reader asked for.
    void finish(const std::vector<std::string_view>& elsewhere = {}) const {
        read_all([] {}, elsewhere);
    }

  private:
    friend class ConfigTable;
    struct Impl;
    explicit ConfigFile(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace thimble
