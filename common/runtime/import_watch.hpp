// Counts what a loaded plug-in asks of the C library while watched calls run: memory, clocks, files. It replaces the addresses that the
// dynamic linker wrote for these functions, in all objects of this process but the C library, so use it in a child (isolated.hpp).
#pragma once

#include <cstdint>

namespace thimble {

struct ImportCounts {
    std::uint64_t allocations = 0;
    std::uint64_t clocks = 0;  // readings of any clock
    std::uint64_t files = 0;   // opened, read or written, and the system's random bytes
};

// From now on. Returns false if the process has no such addresses to replace, on a system other than Linux with glibc.
bool watch_imports();

// Counts the calls of this thread while it exists.
class ImportWatch {
  public:
    ImportWatch();
    ~ImportWatch();
    ImportWatch(const ImportWatch&) = delete;
    ImportWatch& operator=(const ImportWatch&) = delete;
    static ImportCounts counts();  // of all watches of this thread together
};

}  // namespace thimble
