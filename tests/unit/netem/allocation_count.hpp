// Counts what goes through operator new. Replaces the global operators: include in one source of a test
// program only.
#pragma once

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <new>

namespace thimble::test {

inline std::atomic<std::uint64_t> allocations{0};

inline void* counted_allocation(std::size_t bytes) {
    ++allocations;
    if (void* memory = std::malloc(bytes == 0 ? 1 : bytes)) return memory;
    throw std::bad_alloc();
}

}  // namespace thimble::test

// g++ 12 inlines one of a pair and not the other, and then misses the match.
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"

void* operator new(std::size_t bytes) { return thimble::test::counted_allocation(bytes); }
void* operator new[](std::size_t bytes) { return thimble::test::counted_allocation(bytes); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
    ++thimble::test::allocations;
    const auto step = static_cast<std::size_t>(alignment);
    if (void* memory = std::aligned_alloc(step, (bytes + step - 1) / step * step)) return memory;
    throw std::bad_alloc();
}
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
