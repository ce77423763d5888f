// One direction of a profile: the keys of link_reader.hpp, with the files that they name, and written.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "netem/link_reader.hpp"

namespace thimble {

// The text of a file that a profile names, from beside it or out of the program.
using FileFinder = std::function<std::string(std::string_view name)>;

// How a link's tables and traces are read. Throws Error (data) for what is wrong in a file.
LinkSources sources_of(const FileFinder& find);

// The keys of link_reader.hpp, one line each, without those at their defaults. Files of tables and traces are not written: a
// link that has them gets a comment instead.
std::string print_profile_link(const LinkSettings& link);

}  // namespace thimble
