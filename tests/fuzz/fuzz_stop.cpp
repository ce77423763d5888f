// libFuzzer on the stop bus: nothing that is said without the lab key stops or releases; whatever is said without any lab key
// around, is counted.
#include <cstdio>
#include <cstdlib>

#include "tests/fuzz/stop_check.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::span rest(data + 1, size - 1);
    const thimble::Verdict verdict =
        data[0] % 2 == 0 ? thimble::check_stop_script(rest) : thimble::check_stop_bytes(rest);
    if (!verdict.flaw.empty()) {
        std::fprintf(stderr, "fuzz_stop: %s\n", verdict.flaw.c_str());
        std::abort();
    }
    return 0;
}
