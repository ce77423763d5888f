// libFuzzer on the handshake: whatever is said, changed, repeated or turned back on the wire, no word is taken that nobody said,
// and none twice.
#include <cstdio>
#include <cstdlib>

#include "tests/fuzz/security_check.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const thimble::Verdict verdict = thimble::check_handshake_bytes({data, size});
    if (!verdict.flaw.empty()) {
        std::fprintf(stderr, "fuzz_handshake: %s\n", verdict.flaw.c_str());
        std::abort();
    }
    return 0;
}
