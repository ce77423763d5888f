// Packets in the order of their due times. Rising times go to a chain, as all do on a link in order. Packets that
// overtake go to a heap, which costs several times as much.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "common/time.hpp"
#include "netem/packet_store.hpp"

namespace thimble {

class DelayLine {
  public:
    // in_order: it leaves no earlier than any before it; its due time is raised if need be.
    void add(Packet* packet, bool in_order) {
        // The chain's end is due at last_due_ns_, and every packet of the heap before it.
        if (packet->due_ns >= last_due_ns_ || (!in_order && chain_.empty())) {
            last_due_ns_ = packet->due_ns;
        } else if (in_order) {
            packet->due_ns = last_due_ns_;
        } else {
            return add_to_heap(packet);
        }
        chain_.append(packet);
    }

    bool empty() const { return chain_.empty() && heap_.empty(); }
    SessionTime next_due() const {
        if (!heap_.empty()) return from_nanoseconds(std::min(heap_.front().due_ns, chain_due_ns()));
        return chain_.empty() ? kNever : from_nanoseconds(chain_.front()->due_ns);
    }
    // Precondition: not empty. With equal due times the packet that was added first.
    Packet* take_first() {
        // With equal due times, heap packets are younger than chain packets.
        if (heap_.empty() || chain_due_ns() <= heap_.front().due_ns) return chain_.take_front();
        return take_from_heap();
    }
    // Precondition: empty. Forgets the last due time.
    void reset() { last_due_ns_ = INT64_MIN; }

  private:
    struct Waiting {
        std::int64_t due_ns;
        std::uint64_t order;  // a packet before its copy, both before the next packet
        Packet* packet;
    };
    // For std::push_heap. Never equal, so that the order is the same everywhere.
    static bool leaves_later(const Waiting& a, const Waiting& b) {
        return a.due_ns != b.due_ns ? a.due_ns > b.due_ns : a.order > b.order;
    }
    std::int64_t chain_due_ns() const { return chain_.empty() ? INT64_MAX : chain_.front()->due_ns; }
    void add_to_heap(Packet* packet) {
        heap_.push_back({packet->due_ns, 2 * packet->number + (packet->copy ? 1 : 0), packet});
        std::push_heap(heap_.begin(), heap_.end(), leaves_later);
    }
    Packet* take_from_heap() {
        std::pop_heap(heap_.begin(), heap_.end(), leaves_later);
        Packet* first = heap_.back().packet;
        heap_.pop_back();
        return first;
    }

    PacketChain chain_;
    std::vector<Waiting> heap_;
    std::int64_t last_due_ns_ = INT64_MIN;
};

}  // namespace thimble
