// libFuzzer on both ends of the CAN bus: cannelloni's datagrams, the master's ears (SDO replies, process data, heartbeats, EMCY)
// and the emulated drive's.
#include <cstdio>
#include <cstdlib>

#include "tests/fuzz/can_check.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (const char* flaw = thimble::flaw_of_bus({data, size})) {
        std::fprintf(stderr, "fuzz_can: %s\n", flaw);
        std::abort();
    }
    return 0;
}
