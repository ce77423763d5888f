// The result of one hostile text: fuzzers abort on it, tests report it.
#pragma once

#include <string>

namespace thimble {

struct Verdict {
    bool accepted = false;
    std::string flaw;  // empty if all is as it was promised
};

}  // namespace thimble
