// Configuration files people write: TOML, read strictly. An unknown key, a wrong type or a value out of range
// ends the program with file, line and what is allowed (exit code 2).
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/time.hpp"

namespace thimble {

class ConfigFile;

// The reader's description of a key, as text for people. A reference that is written from these cannot differ
// from the program.
struct KeyDeclaration {
    std::string type;  // "number", "whole number", "text", "table", "tables", ...; several: "number or table"
    std::string fallback;              // as a file would write it; empty: none
    std::string range;                 // "0 to 60"; empty: any
    std::vector<std::string> choices;  // all that a text may be; empty: not limited
};

// One table of the file. Each read marks its key; ConfigFile::finish() refuses keys that no reader asked for.
// A missing table or key leaves the default. Copyable handle; lives no longer than its ConfigFile.
class ConfigTable {
  public:
    double number(std::string_view key, double fallback, double low, double high) const;
    std::int64_t integer(std::string_view key, std::int64_t fallback, std::int64_t low,
                         std::int64_t high) const;
    bool boolean(std::string_view key, bool fallback) const;
    std::string text(std::string_view key, std::string_view fallback) const;
    // Index of the text in `choices`; refuses anything else, naming the choices.
    std::size_t choice(std::string_view key, std::size_t fallback,
                       const std::vector<std::string_view>& choices) const;
    // Seconds in the file (a key ending in _s), nanoseconds in the program.
    Duration seconds(std::string_view key, Duration fallback, Duration low, Duration high) const;
    std::vector<double> numbers(std::string_view key, const std::vector<double>& fallback, double low,
                                double high) const;
    std::vector<std::string> texts(std::string_view key, const std::vector<std::string>& fallback) const;
    bool has(std::string_view key) const;
    // Of a key that may be text or something else; false where it is absent.
    bool is_text(std::string_view key) const;
    // Of a key that may be a table or something else; false where it is absent.
    bool is_table(std::string_view key) const;
    ConfigTable table(std::string_view key) const;
    // One table [key] or an array of tables [[key]], in the order of the file; none if absent.
    std::vector<ConfigTable> tables(std::string_view key) const;
    // An Error (usage) that names file, line and key; for checks that span several keys.
    [[noreturn]] void fail(std::string_view key, std::string_view why) const;

  private:
    friend class ConfigFile;
    struct Found;
    Found find(std::string_view key) const;
    ConfigTable(const ConfigFile* file, std::string path) : file_(file), path_(std::move(path)) {}
    const ConfigFile* file_;
    void declare(std::string_view key, std::string_view type, std::string fallback = {},
                 std::string range = {}, std::vector<std::string> choices = {}) const;
    std::string path_;  // dotted, "" for the root
};

class ConfigFile {
  public:
    // Throws Error (usage) if the file is missing or is not TOML.
    static ConfigFile load(const std::filesystem::path& path);
    static ConfigFile parse(std::string_view text, std::string_view name);
    static ConfigFile empty();
    ~ConfigFile();
    ConfigFile(ConfigFile&&) noexcept;
    ConfigFile& operator=(ConfigFile&&) noexcept;

    // The same as if the file said `value` under this dotted key ("operator.criterion_N"). Throws Error (usage)
    // if a table on the way is none. Positions in later messages are then those of what is left of the file.
    void set(std::string_view dotted_key, double value);

    ConfigTable root() const;
    // Where the file lies, which relative paths in it start from; empty for text that was no file.
    const std::filesystem::path& folder() const;
    // For readers of keys that name files: `name`, as written, was read from beside this file. A copy of the file on another machine needs these too.
    void uses(std::string_view name) const;
    const std::set<std::string>& used_files() const;
    ConfigTable table(std::string_view key) const { return root().table(key); }
    // From now on each read notes what it says of its key, by dotted path; [[table]] of several counts from 0: "table[0].key".
    void note_declarations();
    const std::map<std::string, KeyDeclaration>& declarations() const;
    // Throws for each key that was never read, also in arrays of tables. Tables in `elsewhere` belong to other programs of the session:
    // their keys are theirs to check.
    void finish(const std::vector<std::string_view>& elsewhere = {}) const;

  private:
    friend class ConfigTable;
    struct Impl;
    explicit ConfigFile(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace thimble
