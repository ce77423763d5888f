// libFuzzer on sealed datagrams and words about keys: nothing opens without the key, and words mean one thing.
#include <cstdio>
#include <cstdlib>

#include "tests/fuzz/security_check.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const thimble::Verdict verdict = thimble::check_sealed_bytes({data, size});
    if (!verdict.flaw.empty()) {
        std::fprintf(stderr, "fuzz_sealed: %s\n", verdict.flaw.c_str());
        std::abort();
    }
    return 0;
}
