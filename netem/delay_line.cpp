#include "netem/delay_line.hpp"

namespace thimble {

void DelayLine::add_to_heap(Packet* packet) {
    heap_.push_back({packet->due_ns, 2 * packet->number + (packet->copy ? 1 : 0), packet});
    std::push_heap(heap_.begin(), heap_.end(), leaves_later);
}

Packet* DelayLine::take_from_heap() {
    std::pop_heap(heap_.begin(), heap_.end(), leaves_later);
    Packet* first = heap_.back().packet;
    heap_.pop_back();
    return first;
}

}  // namespace thimble
