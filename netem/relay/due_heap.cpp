#include "netem/relay/due_heap.hpp"

namespace thimble {

void DueHeap::set(std::uint32_t link, SessionTime due) {
    assert(link < place_.size());
    const std::uint32_t place = place_[link];
    if (due == kNever) {
        if (place != kNowhere) remove(place);
    } else if (place == kNowhere) {
        heap_.push_back({due, link});
        settle(heap_.size() - 1, {due, link});
    } else if (heap_[place].due != due) {
        settle(place, {due, link});
    }
}

void DueHeap::remove(std::size_t place) {
    place_[heap_[place].link] = kNowhere;
    const Entry last = heap_.back();
    heap_.pop_back();
    if (place < heap_.size()) settle(place, last);
}

// Up towards the front or down, whichever the entry's time asks for.
void DueHeap::settle(std::size_t place, const Entry& entry) {
    while (place > 0 && before(entry, heap_[(place - 1) / 2])) {
        put(place, heap_[(place - 1) / 2]);
        place = (place - 1) / 2;
    }
    for (std::size_t child = 2 * place + 1; child < heap_.size(); child = 2 * place + 1) {
        if (child + 1 < heap_.size() && before(heap_[child + 1], heap_[child])) ++child;
        if (!before(heap_[child], entry)) break;
        put(place, heap_[child]);
        place = child;
    }
    put(place, entry);
}

}  // namespace thimble
