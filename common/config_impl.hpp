// Shared by the readers of tables (config.cpp) and of files (config_file.cpp), and by no other source.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "common/config.hpp"
#include "common/error.hpp"

namespace thimble {

// Of its value alone, or of what other keys say, which may be wrong themselves.
enum class KeyFault : std::uint8_t { kOwn, kWithOthers };

// One key of a file is refused. ConfigFile::read_all() reads on without it.
class KeyError : public Error {
  public:
    KeyError(const std::string& file, std::string key_path, const toml::source_position& place,
             std::string reason, KeyFault key_fault)
        : Error(ExitCode::kUsage, place.line == 0
                                      ? fmt::format("{}: {}", file, reason)
                                      : fmt::format("{}:{}:{}: {}", file, place.line, place.column, reason)),
          path(std::move(key_path)),
          at(place),
          why(std::move(reason)),
          fault(key_fault) {}
    // A mistake in another file, which this key names: in that file's words.
    KeyError(const Error& other, std::string key_path, const toml::source_position& place)
        : Error(other), path(std::move(key_path)), at(place) {}

    // The reason without the key's own path, whose words another table's wrong key may share.
    std::string_view reason() const {
        return std::string_view(why).substr(std::min(why.size(), path.size() + 2));
    }

    std::string path;  // dotted
    toml::source_position at;
    std::string why;
    KeyFault fault = KeyFault::kOwn;
};

inline std::string join(std::string_view path, std::string_view key) {
    return path.empty() ? std::string(key) : fmt::format("{}.{}", path, key);
}

inline std::string as_written(const toml::node& node) {
    // The shortest digits: those of the library say 0.1 as 0.10000000000000001.
    if (node.is_floating_point()) return fmt::format("{}", *node.value<double>());
    std::ostringstream text;
    node.visit([&text](const auto& held) { text << held; });
    return text.str();
}

struct ConfigFile::Impl {
    std::string name;
    std::filesystem::path folder;
    toml::table root;
    std::set<std::string> known;  // dotted paths that a reader asked for
    std::set<std::string> used;   // names of files
    bool describes = false;
    std::vector<KeyDeclaration> declared;

    // Of a key, or of the innermost table of the file that it would stand in.
    toml::source_position place_of(std::string_view path) const;
    // Takes the refused key out of the file: without one, a key beside it that the reason names, else the table. False if there is none.
    bool forget(const KeyError& error);
};

}  // namespace thimble
