// libFuzzer on tables of trials, trajectories and events, as a session leaves them.
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "tests/fuzz/recorded_check.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const thimble::Verdict verdict =
        thimble::check_recorded_file({reinterpret_cast<const char*>(data), size});
    if (!verdict.flaw.empty()) {
        std::fprintf(stderr, "fuzz_recorded: %s\n", verdict.flaw.c_str());
        std::abort();
    }
    return 0;
}
