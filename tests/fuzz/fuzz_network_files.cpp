// libFuzzer on everything that describes a network: whatever the bytes, they are refused as what they are, or good.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "tests/fuzz/network_check.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const thimble::Verdict verdict = thimble::check_network_file({reinterpret_cast<const char*>(data), size});
    if (!verdict.flaw.empty()) {
        std::fprintf(stderr, "fuzz_network_files: %s\n", verdict.flaw.c_str());
        std::abort();
    }
    return 0;
}
