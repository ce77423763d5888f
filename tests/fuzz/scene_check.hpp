// Any text as a scene file: refused as a mistake of its author, or a scene that every solver builds or refuses
// with a step that it takes, and that stays finite wherever the needle goes. One check for the fuzzer and for
// the test of every build.
#pragma once

#include <string_view>

#include "tests/fuzz/verdict.hpp"

namespace thimble {

Verdict check_scene_file(std::string_view text);

}  // namespace thimble
