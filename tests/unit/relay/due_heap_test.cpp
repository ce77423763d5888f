#include "netem/relay/due_heap.hpp"

#include <set>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

namespace thimble {
namespace {

// Of equal times the lowest link is the first.
RC_GTEST_PROP(DueHeap, IsAMapSortedByTime, ()) {
    constexpr std::uint32_t kLinks = 9;
    DueHeap heap(kLinks);
    std::set<std::pair<SessionTime, std::uint32_t>> model;
    const auto steps = *rc::gen::container<std::vector<std::pair<std::uint32_t, int>>>(
        rc::gen::pair(rc::gen::inRange(0U, kLinks), rc::gen::inRange(0, 20)));
    for (const auto& [link, time] : steps) {
        const SessionTime due = time == 0 ? kNever : from_nanoseconds(time);
        heap.set(link, due);
        std::erase_if(model, [&, number = link](const auto& entry) { return entry.second == number; });
        if (due != kNever) model.emplace(due, link);
        RC_ASSERT(heap.empty() == model.empty());
        RC_ASSERT(heap.first_due() == (model.empty() ? kNever : model.begin()->first));
        if (!model.empty()) RC_ASSERT(heap.first() == model.begin()->second);
    }
}

}  // namespace
}  // namespace thimble
