// Memory for packets in flight: blocks of a few sizes, taken from chains of free ones. It grows with what is in flight
// and allocates nothing once it has grown; what was needed once is kept.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include "common/channel.hpp"

namespace thimble {

// Head of a block; the bytes follow it.
struct Packet {
    Packet* next;
    std::int64_t due_ns;       // when it leaves; at the transmitter: its delay from there
    std::int64_t received_ns;  // when it was pushed
    std::uint64_t number;
    std::uint32_t size;
    std::uint8_t size_class;
    bool copy;
    bool corrupted;
    std::uint8_t traffic_class;  // DSCP and ECN bits

    std::uint8_t* data() { return reinterpret_cast<std::uint8_t*>(this + 1); }
    Bytes bytes() { return {data(), size}; }
};

// Packets in a row, first in, first out.
class PacketChain {
  public:
    bool empty() const { return head_ == nullptr; }
    Packet* front() const { return head_; }
    void append(Packet* packet) {
        packet->next = nullptr;
        (head_ == nullptr ? head_ : tail_->next) = packet;
        tail_ = packet;
    }
    Packet* take_front() {
        Packet* first = head_;
        head_ = first->next;
        return first;
    }

  private:
    Packet* head_ = nullptr;
    Packet* tail_ = nullptr;  // meaningless if empty
};

// Blocks are 1, 2, 3, 4, 6, 8, 12, ... cache lines, so that a third is unused at worst.
inline constexpr std::size_t kCacheLineBytes = 64;

constexpr std::size_t size_class_of(std::size_t lines) {
    if (lines <= 2) return lines - 1;
    const auto width = static_cast<std::size_t>(std::bit_width(lines - 1));
    return lines <= (std::size_t{3} << (width - 2)) ? 2 * width - 2 : 2 * width - 1;
}

class PacketStore {
  public:
    // A block with these bytes (1 to kLargestDatagramBytes), everything else of it unset but the size.
    Packet* take(Bytes datagram) {
        const std::size_t lines = (sizeof(Packet) + datagram.size() + kCacheLineBytes - 1) / kCacheLineBytes;
        const std::size_t index = size_class_of(lines);
        SizeClass& size_class = classes_[index];
        Packet* packet = size_class.free;
        if (packet != nullptr) {
            size_class.free = packet->next;
        } else {
            packet = take_unused(index);
        }
        packet->size = static_cast<std::uint32_t>(datagram.size());
        packet->size_class = static_cast<std::uint8_t>(index);
        copy(packet->data(), datagram);
        return packet;
    }
    // The bytes stay valid until the next take().
    void give_back(Packet* packet) {
        SizeClass& size_class = classes_[packet->size_class];
        packet->next = size_class.free;
        size_class.free = packet;
    }

    std::size_t reserved_bytes() const { return reserved_bytes_; }  // from the system, used or free

  private:
    struct FreeMemory {
        void operator()(std::byte* memory) const;
    };
    struct SizeClass {
        Packet* free = nullptr;       // the one given back last is used first: it is still in the cache
        std::byte* unused = nullptr;  // never used, up to `end`
        std::byte* end = nullptr;
        std::size_t total_bytes = 0;
    };
    static constexpr std::size_t kClasses = 21;

    // An address, which stands for a message within one program, needs no call.
    static void copy(std::uint8_t* to, Bytes datagram) {
        if (datagram.size() == sizeof(void*)) {
            std::memcpy(to, datagram.data(), sizeof(void*));
        } else {
            std::memcpy(to, datagram.data(), datagram.size());
        }
    }

    Packet* take_unused(std::size_t index);

    std::array<SizeClass, kClasses> classes_{};
    std::vector<std::unique_ptr<std::byte[], FreeMemory>> slabs_;
    std::size_t reserved_bytes_ = 0;
};

}  // namespace thimble
