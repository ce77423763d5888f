// Any text as a needle file: refused with file and line, or samples as session/records/needle_file.hpp promises
// them, that a scene can be stepped along. One check for the fuzzer and for the test of every build.
#pragma once

#include <string_view>

#include "tests/fuzz/verdict.hpp"

namespace thimble {

Verdict check_needle_file(std::string_view text);

}  // namespace thimble
