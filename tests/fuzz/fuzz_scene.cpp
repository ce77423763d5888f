// libFuzzer on scene files: whatever the text, it is refused or gives a scene whose forces stay finite, by every
// solver.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "tests/fuzz/scene_check.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const thimble::Verdict verdict = thimble::check_scene_file({reinterpret_cast<const char*>(data), size});
    if (!verdict.flaw.empty()) {
        std::fprintf(stderr, "fuzz_scene: %s\n", verdict.flaw.c_str());
        std::abort();
    }
    return 0;
}
