#include <filesystem>

#include <gmock/gmock.h>

#include "common/error.hpp"
#include "visual_node/window/captions.hpp"
#include "visual_node/window/gui_layer.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;
using testing::Not;

Page page_of(PageKind kind, double remaining_s = 0) {
    return {.remaining_s = remaining_s, .trial = 3, .trials = 12, .kind = kind};
}

TEST(PageText, CountsABreakDownAndSaysWhichTrialComes) {
    EXPECT_EQ(page_text(page_of(PageKind::kReady)).body, "Trial 3 of 12");
    EXPECT_EQ(page_text(page_of(PageKind::kBreak, 61.2)).body, "1:02 to go");
    EXPECT_EQ(page_text(page_of(PageKind::kBreak, 5)).body, "0:05 to go");
    EXPECT_THAT(page_text(page_of(PageKind::kBreak)).body, Not(HasSubstr("0:00")));
}

TEST(PageText, ALabsOwnWordsStandInPlaceOfOurs) {
    Instructions words;
    words.pages[static_cast<std::size_t>(PageKind::kReady)] = {"Bereit?", "Versuch {trial}"};
    words.pages[static_cast<std::size_t>(PageKind::kDone)].title = "Fertig";
    const PageText ready = page_text(page_of(PageKind::kReady), words, true);
    EXPECT_EQ(ready.title, "Bereit?");
    EXPECT_EQ(ready.body, "Versuch 3") << "and nothing added";
    words.go_on = "Leertaste!";
    EXPECT_EQ(page_text(page_of(PageKind::kReady), words, true).body, "Versuch 3\n\nLeertaste!");
    EXPECT_EQ(page_text(page_of(PageKind::kReady), words, false).body, "Versuch 3");
    const PageText done = page_text(page_of(PageKind::kDone), words, true);
    EXPECT_EQ(done.title, "Fertig");
    EXPECT_EQ(done.body, page_text(page_of(PageKind::kDone)).body);
    EXPECT_TRUE(page_text(page_of(PageKind::kNone), words, true).body.empty());
}

TEST(PageText, SaysHowToGoOnWhereASubjectMay) {
    const Instructions none;
    for (int i = 1; i <= static_cast<int>(PageKind::kWait); ++i) {
        const auto kind = static_cast<PageKind>(i);
        const std::string with = page_text(page_of(kind), none, true).body;
        EXPECT_EQ(with.find("space bar") != std::string::npos, waits_to_go_on(kind)) << i;
        EXPECT_EQ(page_text(page_of(kind), none, false).body, page_text(page_of(kind)).body);
    }
}

TEST(PageText, AQuestionThatThisWindowDoesNotHaveIsNamed) {
    EXPECT_THAT(unknown_question(page_of(PageKind::kQuestion)).body,
                testing::AllOf(HasSubstr("Question 3 is from other pages"), HasSubstr("than this window's")));
}

TEST(Fonts, WhatCannotBeDrawnIsNamed) {
    EXPECT_EQ(undrawable("Grüße, ça va? ¿Qué? Ærø\n{trial}"), "");
    if (std::filesystem::exists("/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf")) {
        EXPECT_EQ(undrawable("Готовы? Έτοιμοι; Připraveni? Gotowi? Hazır mısınız?"), "");
    }
    EXPECT_EQ(undrawable("a\xF0\x9F\x98\x80 \xE4\xB8\xAD\xE4\xB8\xAD"), "U+4E2D, U+1F600");
    EXPECT_THROW(check_drawable("\xE4\xB8\xAD"), Error);
    EXPECT_NO_THROW(check_drawable(""));
}

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
