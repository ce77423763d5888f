// The link that is due next among many. A link's time can change at any moment, without an allocation.
#pragma once

#include <cstdint>
#include <vector>

#include <boost/intrusive/set.hpp>

#include "common/time.hpp"

namespace thimble {

class DueHeap {
  public:
    // Links are numbered from 0 to `links` - 1; none has a time yet.
    explicit DueHeap(std::size_t links) : entries_(links) {
        for (std::uint32_t link = 0; link < links; ++link) entries_[link].link = link;
    }

    bool empty() const { return waiting_.empty(); }
    SessionTime first_due() const { return empty() ? kNever : waiting_.begin()->due; }
    std::uint32_t first() const { return waiting_.begin()->link; }

    // kNever takes the link out.
    void set(std::uint32_t link, SessionTime due) {
        Entry& entry = entries_[link];
        if (entry.due == due) return;
        if (entry.due != kNever) waiting_.erase(waiting_.iterator_to(entry));
        entry.due = due;
        if (due != kNever) waiting_.insert(entry);
    }

  private:
    struct Entry : boost::intrusive::set_base_hook<> {
        SessionTime due = kNever;
        std::uint32_t link = 0;
        // Equal times: the lower number first, so that the order never depends on history.
        bool operator<(const Entry& other) const {
            return due != other.due ? due < other.due : link < other.link;
        }
    };

    std::vector<Entry> entries_;
    boost::intrusive::set<Entry> waiting_;
};

}  // namespace thimble
