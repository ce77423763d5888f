// [instructions]: a lab's own words, and what stands in braces.
#include "visual_node/instructions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/refusal.hpp"

namespace thimble {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Instructions read_words(const std::string& text) {
    const ConfigFile file = ConfigFile::parse("[instructions]\n" + text, "words.toml");
    const Instructions words = read_instructions(file.table("instructions"));
    file.finish();
    return words;
}

std::string refusal_of(const std::string& text) {
    return refusal([&] { read_words(text); }, ExitCode::kUsage);
}

Page page_with(PageKind kind, double remaining_s = 0) {
    return {.remaining_s = remaining_s, .trial = 3, .trials = 12, .kind = kind};
}

TEST(Instructions, AreReadPageByPage) {
    const Instructions words = read_words(
        "ready_title = 'Bereit?'\nready = 'Versuch {trial} von {trials}'\ndone = ''\n"
        "break = 'Noch {break_s} s, {break_time}'\n");
    EXPECT_EQ(words.of(PageKind::kReady).title, "Bereit?");
    EXPECT_EQ(fill_in(*words.of(PageKind::kReady).body, page_with(PageKind::kReady)), "Versuch 3 von 12");
    EXPECT_EQ(fill_in(*words.of(PageKind::kBreak).body, page_with(PageKind::kBreak, 64.2)),
              "Noch 65 s, 1:05");
    EXPECT_EQ(words.of(PageKind::kDone).body, "");
    EXPECT_FALSE(words.of(PageKind::kWelcome).title);
    EXPECT_FALSE(words.of(PageKind::kReady).title == words.of(PageKind::kBreak).title);
    EXPECT_THAT(words.text(), HasSubstr("Bereit?"));
}

TEST(Instructions, UnknownKeysAndPlaceholdersAreNamed) {
    EXPECT_THAT(refusal_of("welcom = 'x'"), HasSubstr("instructions.welcom"));
    const std::string placeholder = refusal_of("ready = 'now {modality}'");
    EXPECT_THAT(placeholder, HasSubstr("instructions.ready"));
    EXPECT_THAT(placeholder, HasSubstr("{modality}"));
    EXPECT_THAT(placeholder, HasSubstr("{trial}, {trials}"));
    EXPECT_THAT(refusal_of("ready = '{break_s}'"), HasSubstr("{break_s}")) << "no break is on there";
    EXPECT_THAT(refusal_of("done_title = '{trial}'"), HasSubstr("{trials}"));
    EXPECT_THAT(refusal_of("ready = 3"), HasSubstr("text"));
}

TEST(Instructions, BracesComeInPairsOrDoubled) {
    EXPECT_EQ(fill_in("{{trial}} {{{trial}}}", page_with(PageKind::kReady)), "{trial} {3}");
    EXPECT_NO_THROW(read_words("ready = '{{trial}}'"));
    for (const char* alone : {"{", "}", "{trial", "trial}", "{tri{al}", "a } b", "{}"})
        EXPECT_THROW(read_words(std::string("ready = '") + alone + "'"), Error) << alone;
}

TEST(Instructions, NoPlanIsNoNumber) {
    Page page = page_with(PageKind::kReady);
    page.trials = 0;
    EXPECT_EQ(fill_in("{trial} of {trials}", page), "3 of ?");
}

TEST(Instructions, WhoNamesAModalityIsTold) {
    EXPECT_THAT(named_modalities(read_words("ready = 'Now VF, not CCF.'")),
                ElementsAre(HasSubstr("names CCF"), HasSubstr("names VF")));
    EXPECT_THAT(named_modalities(read_words("ready = 'HFor aCF'")), IsEmpty());
}

}  // namespace
}  // namespace thimble
