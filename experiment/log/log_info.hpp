// What stands in a log, for people.
#pragma once

#include <string>

#include "experiment/log/logged_file.hpp"

namespace thimble {

std::string describe_log(const LoggedFile& file);

}  // namespace thimble
