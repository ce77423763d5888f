#include "netem/packet_store.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <new>

namespace thimble {
namespace {

// A cache line; blocks are 1, 2, 3, 4, 6, 8, 12, ... of them, so that a third is unused at worst.
constexpr std::size_t kUnitBytes = 64;
constexpr std::size_t kFirstSlabBytes = 4096;
constexpr std::size_t kLargestSlabBytes = std::size_t{1} << 20;

std::size_t class_of(std::size_t units) {
    if (units <= 2) return units - 1;
    const auto width = static_cast<std::size_t>(std::bit_width(units - 1));
    return units <= (std::size_t{3} << (width - 2)) ? 2 * width - 2 : 2 * width - 1;
}

constexpr std::size_t units_in(std::size_t size_class) {
    if (size_class == 0) return 1;
    return size_class % 2 == 1 ? std::size_t{1} << ((size_class + 1) / 2)
                               : std::size_t{3} << (size_class / 2 - 1);
}

}  // namespace

void PacketStore::FreeMemory::operator()(std::byte* memory) const {
    ::operator delete (memory, std::align_val_t{kUnitBytes});
}

Packet* PacketStore::take(Bytes datagram) {
    const std::size_t index = class_of((sizeof(Packet) + datagram.size() + kUnitBytes - 1) / kUnitBytes);
    assert(index < kClasses);
    SizeClass& size_class = classes_[index];
    Packet* packet = size_class.free;
    if (packet != nullptr) {
        size_class.free = packet->next;
    } else {
        packet = take_unused(index);
    }
    packet->size = static_cast<std::uint32_t>(datagram.size());
    packet->size_class = static_cast<std::uint8_t>(index);
    std::memcpy(packet->data(), datagram.data(), datagram.size());
    return packet;
}

// Each slab is as large as all before it, within limits: few allocations, and at most twice what is needed.
Packet* PacketStore::take_unused(std::size_t index) {
    SizeClass& size_class = classes_[index];
    const std::size_t block_bytes = units_in(index) * kUnitBytes;
    if (size_class.unused == size_class.end) {
        const std::size_t wanted = std::clamp(size_class.total_bytes, kFirstSlabBytes, kLargestSlabBytes);
        const std::size_t bytes = std::max<std::size_t>(wanted / block_bytes, 1) * block_bytes;
        auto* memory = static_cast<std::byte*>(::operator new (bytes, std::align_val_t{kUnitBytes}));
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

void PacketStore::give_back(Packet* packet) {
    SizeClass& size_class = classes_[packet->size_class];
    packet->next = size_class.free;
    size_class.free = packet;
}

}  // namespace thimble
