#include "visual_node/window/page_text.hpp"

#include <gmock/gmock.h>

namespace thimble {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

Page page_of(PageKind kind, double remaining_s = 0) {
    Page page;
    page.kind = kind;
    page.remaining_s = remaining_s;
    page.trial = 3;
    page.trials = 12;
    return page;
}

TEST(PageText, CountsABreakDown) {
    EXPECT_EQ(page_text(page_of(PageKind::kBreak, 61.2)).body, "1:02 to go");
    EXPECT_EQ(page_text(page_of(PageKind::kBreak, 5)).body, "0:05 to go");
    EXPECT_THAT(page_text(page_of(PageKind::kBreak)).body, Not(HasSubstr("0:00")));
}

TEST(PageText, SaysWhichTrialComes) { EXPECT_EQ(page_text(page_of(PageKind::kReady)).body, "Trial 3 of 12"); }

TEST(PageText, EveryPageHasATitleAndNoneNamesAModality) {
    for (int i = 1; i <= static_cast<int>(PageKind::kWait); ++i) {
        const PageText text = page_text(page_of(static_cast<PageKind>(i)));
        EXPECT_FALSE(text.title.empty()) << i;
        for (const char* secret : {"HF", "CF", "CCF", "VF", "fixture", "delay"}) {
            EXPECT_THAT(text.title + text.body, Not(HasSubstr(secret)));
        }
    }
    EXPECT_TRUE(page_text(page_of(PageKind::kNone)).title.empty());
}

}  // namespace
}  // namespace thimble
