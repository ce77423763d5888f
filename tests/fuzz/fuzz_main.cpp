// libFuzzer's end of every check; CMake says which one this program is.
#include <cstdio>
#include <cstdlib>

#include "tests/fuzz/checks.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const thimble::Verdict verdict = thimble::THIMBLE_CHECK({data, size});
    if (verdict.flaw.empty()) return 0;
    std::fprintf(stderr, "%s\n", verdict.flaw.c_str());
    std::abort();
}
