// The subject's key: said again until the page is turned, and for no other page.
#include "visual_node/go_on_request.hpp"

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
int said_between(GoOnRequest& request, int from_ms, int to_ms) {
    int said = 0;
    for (int ms = from_ms; ms < to_ms; ++ms) said += request.take_due(at(milliseconds{ms})) ? 1 : 0;
    return said;
}

TEST(GoOnRequest, IsRepeatedWhileItsPageStandsAndThenForgotten) {
    GoOnRequest request(true);
    request.turn(at(milliseconds{0}), ready_page(1));
    EXPECT_EQ(said_between(request, 0, 100), 0);
    request.press(at(milliseconds{100}));
    request.turn(at(milliseconds{110}), ready_page(1));  // said again by the session
    EXPECT_EQ(said_between(request, 100, 300), 4);
    request.turn(at(milliseconds{300}), ready_page(2));
    EXPECT_EQ(said_between(request, 300, 600), 0);
    request.press(at(milliseconds{600}));
    EXPECT_EQ(said_between(request, 600, 5000), 40) << "for two seconds";
    request.press(at(milliseconds{5000}));
    EXPECT_EQ(said_between(request, 5000, 5010), 1) << "pressed again";
}

TEST(GoOnRequest, IsNothingWhereNoPageWaitsOrTheProtocolForbidsIt) {
    GoOnRequest request(true);
    request.press(at(milliseconds{0}));  // in a trial
    request.turn(at(milliseconds{1}), ready_page(1));
    EXPECT_EQ(said_between(request, 1, 200), 0);
    Page rest = ready_page(2);
    rest.kind = PageKind::kBreak;
    request.turn(at(milliseconds{200}), rest);
    request.press(at(milliseconds{201}));
    EXPECT_EQ(request.next(), kNever);
    EXPECT_EQ(said_between(request, 201, 400), 0);

    GoOnRequest forbidden(false);
    forbidden.turn(at(milliseconds{0}), ready_page(1));
    forbidden.press(at(milliseconds{1}));
    EXPECT_EQ(forbidden.next(), kNever);
    EXPECT_EQ(said_between(forbidden, 1, 200), 0);
}

}  // namespace
}  // namespace thimble
