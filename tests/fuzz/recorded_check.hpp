// Any text as what a session leaves on the disk: a table of trials, a trajectory, the events beside it. Each reader refuses it with
// its file, as damaged data, or gives rows that are the same when they are written and read again. One check for the fuzzer and for
// the test of every build.
#pragma once

#include <string_view>

#include "tests/fuzz/verdict.hpp"

namespace thimble {

// Accepted: by one of the three readers.
Verdict check_recorded_file(std::string_view text);

}  // namespace thimble
