#pragma once

#include <cstdint>

namespace thimble::test {

// Calls of any operator new so far, in the whole program.
std::uint64_t allocation_count();

}  // namespace thimble::test
