// libFuzzer on the reader of logs: whatever the bytes, it neither crashes nor makes a bad file of them.
#include <cstdio>
#include <cstdlib>

#include "tests/fuzz/mcap_check.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (const char* flaw = thimble::flaw_of_log({data, size})) {
        std::fprintf(stderr, "fuzz_log: %s\n", flaw);
        std::abort();
    }
    return 0;
}
