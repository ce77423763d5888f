// libFuzzer on the only door from the network: whatever the bytes, decode() neither crashes nor lets a bad
// message in.
#include <cstdio>
#include <cstdlib>

#include "common/codec.hpp"
#include "tests/fuzz/packets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const thimble::Decoded decoded = thimble::decode({data, size});
    const char* flaw = nullptr;
    if (decoded.message) {
        flaw = thimble::flaw_of(*decoded.message);
    } else if (!decoded.refusal) {
        flaw = "refused without a reason";
    }
    if (flaw != nullptr) {
        std::fprintf(stderr, "fuzz_decode: %s\n", flaw);
        std::abort();
    }
    return 0;
}
