#include "netem/relay/flow_table.hpp"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "netem/relay/due_heap.hpp"

namespace thimble {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

FlowName client(std::uint16_t port, std::uint32_t inlet = 0) { return {inlet, {0x0100007F, port}}; }
SessionTime at(int s) { return SessionTime{std::chrono::seconds{s}}; }

TEST(FlowTable, KnowsAClientAgain) {
    FlowTable table(4, 1);
    const auto first = table.find(client(1), at(0));
    const auto other = table.find(client(2), at(0));
    const auto again = table.find(client(1), at(1));
    EXPECT_TRUE(first->fresh);
    EXPECT_TRUE(other->fresh);
    EXPECT_FALSE(again->fresh);
    EXPECT_EQ(first->place, again->place);
    EXPECT_NE(first->place, other->place);
    EXPECT_EQ(table.name(first->place), client(1));
}

TEST(FlowTable, TellsIpv6ClientsApart) {
    FlowTable table(8, 1);
    std::set<std::uint32_t> places;
    for (const char* text :
         {"[::1]:9000", "[::1]:9001", "[2001:db8::1]:9000", "[fe80::1]:9000", "127.0.0.1:9000"})
        places.insert(table.find({0, read_udp_address(text, "")}, at(0))->place);
    EXPECT_EQ(places.size(), 5U);
    EXPECT_FALSE(table.find({0, read_udp_address("[::1]:9001", "")}, at(1))->fresh);
}

TEST(FlowTable, KeepsInletsApart) {
    FlowTable table(4, 2);
    const auto here = table.find(client(1, 0), at(0)), there = table.find(client(1, 1), at(0));
    EXPECT_NE(here->place, there->place);
    EXPECT_EQ(table.number(here->place), 0U);
    EXPECT_EQ(table.number(there->place), 0U) << "each inlet counts its own flows";
}

TEST(FlowTable, TakesNoMoreThanFit) {
    FlowTable table(2, 1);
    table.find(client(1), at(0));
    table.find(client(2), at(0));
    EXPECT_FALSE(table.find(client(3), at(0)));
    EXPECT_TRUE(table.find(client(2), at(0)));
}

TEST(FlowTable, GivesAPlaceAgainButNeverANumber) {
    FlowTable table(1, 1);
    const std::uint32_t place = table.find(client(1), at(0))->place;
    table.close(place);
    const auto next = table.find(client(1), at(9));
    EXPECT_TRUE(next->fresh);
    EXPECT_EQ(next->place, place);
    EXPECT_EQ(table.number(place), 1U) << "fates must not repeat";
    EXPECT_EQ(table.opened(), 2U);
    EXPECT_EQ(table.size(), 1U);
}

TEST(FlowTable, WhoIsRefusedWasNoFlow) {
    FlowTable table(1, 1);
    table.refuse(table.find(client(1), at(0))->place);
    EXPECT_EQ(table.opened(), 0U);
    const auto next = table.find(client(1), at(1));
    EXPECT_TRUE(next->fresh);
    EXPECT_EQ(table.number(next->place), 0U);
}

TEST(FlowTable, NamesWhoWasSilent) {
    FlowTable table(3, 1);
    const std::uint32_t a = table.find(client(1), at(0))->place;
    const std::uint32_t b = table.find(client(2), at(0))->place;
    const std::uint32_t c = table.find(client(3), at(5))->place;
    table.alive(b, at(6));
    EXPECT_THAT(table.idle_since(at(5)), ElementsAre(a));
    table.find(client(1), at(7));
    EXPECT_THAT(table.idle_since(at(5)), IsEmpty());
    EXPECT_THAT(table.idle_since(at(100)), UnorderedElementsAre(a, b, c));
    table.close(a);
    EXPECT_THAT(table.idle_since(at(100)), UnorderedElementsAre(b, c));
}

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
