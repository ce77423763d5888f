#include "netem/packet_store.hpp"

#include <algorithm>
#include <cassert>
#include <new>

namespace thimble {
namespace {

constexpr std::size_t kFirstSlabBytes = 4096;
constexpr std::size_t kLargestSlabBytes = std::size_t{1} << 20;

constexpr std::size_t lines_in(std::size_t size_class) {
    if (size_class == 0) return 1;
    return size_class % 2 == 1 ? std::size_t{1} << ((size_class + 1) / 2)
                               : std::size_t{3} << (size_class / 2 - 1);
}

}  // namespace

void PacketStore::FreeMemory::operator()(std::byte* memory) const {
    ::operator delete (memory, std::align_val_t{kCacheLineBytes});
}

// Each slab is as large as all before it, within limits: few allocations, and at most twice what is needed.
Packet* PacketStore::take_unused(std::size_t index) {
    assert(index < kClasses);
    SizeClass& size_class = classes_[index];
    const std::size_t block_bytes = lines_in(index) * kCacheLineBytes;
    if (size_class.unused == size_class.end) {
        const std::size_t wanted = std::clamp(size_class.total_bytes, kFirstSlabBytes, kLargestSlabBytes);
        const std::size_t bytes = std::max<std::size_t>(wanted / block_bytes, 1) * block_bytes;
        auto* memory = static_cast<std::byte*>(::operator new (bytes, std::align_val_t{kCacheLineBytes}));
        slabs_.emplace_back(memory);
        size_class.unused = memory;
        size_class.end = memory + bytes;
        size_class.total_bytes += bytes;
        reserved_bytes_ += bytes;
    }
    auto* packet = new (size_class.unused) Packet;
    size_class.unused += block_bytes;
    return packet;
}

}  // namespace thimble
