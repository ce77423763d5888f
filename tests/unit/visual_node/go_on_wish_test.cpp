// The subject's key: said again until the page is turned, and for no other page.
#include "visual_node/go_on_wish.hpp"

#include <gtest/gtest.h>

#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

Page ready_page(std::uint32_t trial) {
    Page page;
    page.kind = PageKind::kReady;
    page.trial = trial;
    return page;
}

// How often it is said from `from` to `to`, looked at each millisecond.
int said_between(GoOnWish& wish, int from_ms, int to_ms) {
    int said = 0;
    for (int ms = from_ms; ms < to_ms; ++ms) said += wish.take_due(at(milliseconds{ms})) ? 1 : 0;
    return said;
}

TEST(GoOnWish, IsRepeatedWhileItsPageStandsAndThenForgotten) {
    GoOnWish wish(true);
    wish.turn(at(milliseconds{0}), ready_page(1));
    EXPECT_EQ(said_between(wish, 0, 100), 0);
    wish.press(at(milliseconds{100}));
    wish.turn(at(milliseconds{110}), ready_page(1));  // said again by the session
    EXPECT_EQ(said_between(wish, 100, 300), 4);
    wish.turn(at(milliseconds{300}), ready_page(2));
    EXPECT_EQ(said_between(wish, 300, 600), 0);
    wish.press(at(milliseconds{600}));
    EXPECT_EQ(said_between(wish, 600, 5000), 40) << "for two seconds";
    wish.press(at(milliseconds{5000}));
    EXPECT_EQ(said_between(wish, 5000, 5010), 1) << "pressed again";
}

TEST(GoOnWish, IsNothingWhereNoPageWaitsOrTheProtocolForbidsIt) {
    GoOnWish wish(true);
    wish.press(at(milliseconds{0}));  // in a trial
    wish.turn(at(milliseconds{1}), ready_page(1));
    EXPECT_EQ(said_between(wish, 1, 200), 0);
    Page rest = ready_page(2);
    rest.kind = PageKind::kBreak;
    wish.turn(at(milliseconds{200}), rest);
    wish.press(at(milliseconds{201}));
    EXPECT_EQ(wish.next(), kNever);
    EXPECT_EQ(said_between(wish, 201, 400), 0);

    GoOnWish forbidden(false);
    forbidden.turn(at(milliseconds{0}), ready_page(1));
    forbidden.press(at(milliseconds{1}));
    EXPECT_EQ(forbidden.next(), kNever);
    EXPECT_EQ(said_between(forbidden, 1, 200), 0);
}

}  // namespace
}  // namespace thimble
