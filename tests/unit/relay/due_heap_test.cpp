#include "netem/relay/due_heap.hpp"

#include <map>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

namespace thimble {
namespace {

TEST(DueHeap, GivesTheEarliestAndOfEqualsTheLowest) {
    DueHeap heap(4);
    EXPECT_EQ(heap.first_due(), kNever);
    heap.set(3, from_nanoseconds(50));
    heap.set(2, from_nanoseconds(20));
    heap.set(1, from_nanoseconds(20));
    EXPECT_EQ(heap.first(), 1U);
    heap.set(1, kNever);
    EXPECT_EQ(heap.first(), 2U);
    heap.set(2, from_nanoseconds(60));
    EXPECT_EQ(heap.first(), 3U);
}

RC_GTEST_PROP(DueHeap, IsAMapSortedByTime, ()) {
    constexpr std::uint32_t kLinks = 9;
    DueHeap heap(kLinks);
    std::map<std::uint32_t, SessionTime> model;
    const auto steps = *rc::gen::container<std::vector<std::pair<std::uint32_t, int>>>(
        rc::gen::pair(rc::gen::inRange(0U, kLinks), rc::gen::inRange(0, 20)));
    for (const auto& [link, time] : steps) {
        const SessionTime due = time == 0 ? kNever : from_nanoseconds(time);
        heap.set(link, due);
        due == kNever ? (void)model.erase(link) : (void)(model[link] = due);
        SessionTime first = kNever;
        for (const auto& [l, t] : model) first = std::min(first, t);
        RC_ASSERT(heap.first_due() == first);
        RC_ASSERT(heap.empty() == model.empty());
        if (!model.empty()) RC_ASSERT(model.at(heap.first()) == first);
    }
}

}  // namespace
}  // namespace thimble
