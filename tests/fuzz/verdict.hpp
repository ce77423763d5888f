// What came of one hostile text: what fuzzers abort on and tests report.
#pragma once

#include <string>

namespace thimble {

struct Verdict {
    bool accepted = false;
    std::string flaw;  // empty if all is as it was promised
};

}  // namespace thimble
