// libFuzzer on HID devices: whatever one says of itself and then reports, axes stay within their ends and a board's word is
// taken only whole.
#include <cstdio>
#include <cstdlib>

#include "tests/fuzz/hid_check.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const thimble::Verdict verdict = thimble::check_hid_bytes({data, size});
    if (!verdict.flaw.empty()) {
        std::fprintf(stderr, "fuzz_hid: %s\n", verdict.flaw.c_str());
        std::abort();
    }
    return 0;
}
