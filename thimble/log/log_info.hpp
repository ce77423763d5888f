// The content of a log, for people.
#pragma once

#include <string>

#include "session/log/logged_file.hpp"

namespace thimble {

// "whole", or what is missing at its end.
std::string describe_end(const LoggedFile& file);
std::string describe_log(const LoggedFile& file);

}  // namespace thimble
