// Which of many links must be looked at next: a binary heap of their due times that knows where each link stands, so
// that a link's time can change at any moment. No allocation after resize().
#pragma once

#include <cassert>
#include <cstdint>
#include <vector>

#include "common/time.hpp"

namespace thimble {

class DueHeap {
  public:
    // Links are numbered from 0 to `links` - 1; none has a time yet.
    explicit DueHeap(std::size_t links) : place_(links, kNowhere) { heap_.reserve(links); }

    bool empty() const { return heap_.empty(); }
    SessionTime first_due() const { return heap_.empty() ? kNever : heap_.front().due; }
    std::uint32_t first() const { return heap_.front().link; }

    // kNever takes the link out.
    void set(std::uint32_t link, SessionTime due);

  private:
    struct Entry {
        SessionTime due;
        std::uint32_t link;
    };
    static constexpr std::uint32_t kNowhere = UINT32_MAX;

    // Equal times: the lower number first, so that the order never depends on history.
    static bool before(const Entry& a, const Entry& b) {
        return a.due != b.due ? a.due < b.due : a.link < b.link;
    }
    void put(std::size_t place, const Entry& entry) {
        heap_[place] = entry;
        place_[entry.link] = static_cast<std::uint32_t>(place);
    }
    void remove(std::size_t place);
    void settle(std::size_t place, const Entry& entry);

    std::vector<Entry> heap_;
    std::vector<std::uint32_t> place_;  // of each link in heap_
};

}  // namespace thimble
