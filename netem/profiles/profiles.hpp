// Networks by name: deploy/profiles at build time, so that programs find them wherever they are started. A profile is
// TOML:
//   about = "one line on what it is like"
//   source = ["delay: ...", ...]   where each value is from; an assumption is called one
//   [up]     from the operator's side to the remote one (needle), keys of link_reader.hpp
//   [down]   back (force)
//   [[change]]   at_s, direction = "up", "down" or "both", and keys of a link: what changes then; the rest stays
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/config.hpp"
#include "netem/formats/tc_text.hpp"
#include "netem/link_reader.hpp"
#include "netem/link_settings.hpp"

namespace thimble {

// The text of a file that a profile names, from beside it or out of the program.
using FileFinder = std::function<std::string(std::string_view name)>;

// How a link's tables and traces are read. Throws Error (data) for what is wrong in a file.
LinkSources sources_of(const FileFinder& find);

// The keys of link_reader.hpp, one line each, without those at their defaults. Files of tables and traces are not written: a
// link that has them gets a comment instead.
std::string print_profile_link(const LinkSettings& link);

struct LinkProfile {
    std::string name, about;
    std::vector<std::string> source;
    LinkSettings up, down;
    Timeline up_changes, down_changes;
    std::vector<std::string> notes{};     // what of tc's words was left out or means another thing here
    bool one_way = false;                 // tc's words, which say nothing about the way down
    std::optional<std::uint64_t> seed{};  // of tc's words
};

struct BuiltInFile {
    std::string_view name;  // "leo.toml", "leo.csv"
    std::string_view text;
};
const std::vector<BuiltInFile>& built_in_profile_files();

// The built-in ones, from the nearest network to the farthest.
const std::vector<std::string_view>& profile_names();

// A built-in profile by name, null if there is none. All are read at the first call and kept: later ones take no time.
const LinkProfile* built_in_profile(std::string_view name);

// A built-in profile by name ("leo"), a file ("my/lab.toml"), or tc's words ("delay 50ms loss 1%", tc_text.hpp), which are
// the way up unless they say otherwise. Throws Error (usage), naming the profiles there are.
LinkProfile load_profile(const std::string& given);
LinkProfile parse_profile(std::string_view text, std::string_view name, const FileFinder& find);
// The tables of a profile; keys that it does not know are left to file.finish().
LinkProfile read_profile(const ConfigFile& file, std::string_view name, const FileFinder& find);

// For one direction of a session file in `folder`: tables and traces beside it, and `profile = ` anything that
// load_profile takes, a file first sought in `folder`; tc's words are that one direction's. A profile whose settings
// change with time is refused: the session's own [[timeline]] is the place for that. `read` hears the name, as seen
// from `folder`, of every file that is read.
using FileRead = std::function<void(std::string_view name)>;
LinkSources session_sources(const std::filesystem::path& folder, Way way, const FileRead& read = {});

// TOML that parse_profile reads; without changes.
std::string print_profile(const LinkProfile& profile);

}  // namespace thimble
