// libFuzzer on needle files: whatever the text, it is refused with its line or gives samples that can be trusted.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "tests/fuzz/needle_check.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const thimble::Verdict verdict = thimble::check_needle_file({reinterpret_cast<const char*>(data), size});
    if (!verdict.flaw.empty()) {
        std::fprintf(stderr, "fuzz_needle: %s\n", verdict.flaw.c_str());
        std::abort();
    }
    return 0;
}
