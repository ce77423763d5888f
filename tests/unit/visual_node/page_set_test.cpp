// Page sets: what a subject reads and answers, from files that people write.
#include "visual_node/page_set.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/refusal.hpp"
#include "visual_node/question_form.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

PageSet pages_of(const std::string& text) {
    const ConfigFile file = ConfigFile::parse(text, "pages.toml");
    PageSet pages;
    file.read_all([&] { pages = read_page_set(file); });
    return pages;
}

std::string pages_refusal(const std::string& text) {
    return refusal([&] { pages_of(text); }, ExitCode::kUsage);
}

constexpr const char* kForm = "[[questionnaire]]\nname = 'ease'\n[[questionnaire.question]]\n";

std::vector<std::string> ids_of(const PageSet& pages) {
    std::vector<std::string> ids;
    for (const Questionnaire& form : pages.questionnaires)
        for (const Question& q : form.questions)
            ids.push_back(fmt::format("{}.{} {} to {}", form.name, q.id, q.from, q.to));
    return ids;
}

// Data of several languages go into one table.
TEST(PageSet, TheShippedOnesAskTheSameInEachLanguage) {
    ASSERT_EQ(built_in_pages().size(), 4U);
    const auto english = std::find_if(built_in_pages().begin(), built_in_pages().end(),
                                      [](const BuiltInPages& set) { return set.name == "en.toml"; });
    const PageSet first = pages_of(std::string(english->text));
    EXPECT_EQ(first.questionnaires.size(), 3U);
    for (const BuiltInPages& set : built_in_pages()) {
        const PageSet pages = pages_of(std::string(set.text));
        EXPECT_EQ(ids_of(pages), ids_of(first)) << set.name;
        ASSERT_TRUE(pages.consent) << set.name;
        ASSERT_TRUE(pages.instructions.go_on) << set.name;
        for (const PageWords& words : pages.instructions.pages)
            EXPECT_THAT(words.body.value_or(""), testing::Not(HasSubstr(*pages.instructions.go_on)));
        EXPECT_THAT(named_modalities(pages.instructions), testing::IsEmpty()) << set.name;
        EXPECT_EQ(pages.shown().size(), 15U) << set.name;
    }
}

TEST(PageSet, ASessionNamesOneAndItsOwnWordsWin) {
    const ConfigFile file =
        ConfigFile::parse("[instructions]\npages = 'it.toml'\nready = 'Via! {trial}'\n", "session.toml");
    PageSet pages;
    file.read_all([&] { pages = read_pages(file); });
    EXPECT_EQ(pages.instructions.of(PageKind::kReady).body, "Via! {trial}");
    EXPECT_EQ(pages.instructions.of(PageKind::kDone).title, "Fine");
    EXPECT_EQ(pages.first_number(0), 2U) << "behind the consent page";
    const ConfigFile other = ConfigFile::parse("[instructions]\npages = 'xx.toml'\n", "session.toml");
    EXPECT_THAT(refusal([&] { other.read_all([&] { read_pages(other); }); }, ExitCode::kUsage),
                testing::AllOf(HasSubstr("[instructions] pages is xx.toml"), HasSubstr("it.toml")));
}

TEST(PageSet, ABreakHasTheTextOfTheProtocolUnlessThePagesHaveOne) {
    const auto rest = [](const std::string& text) {
        const ConfigFile file = ConfigFile::parse("[protocol]\nbreak_text = 'Rest {5}'\n" + text, "s.toml");
        const PageSet pages = read_pages(file);
        return fill_in(pages.instructions.of(PageKind::kBreak).body.value_or(""), {.remaining_s = 65});
    };
    EXPECT_EQ(rest(""), "Rest {5}\n1:05 to go");
    EXPECT_EQ(rest("[instructions]\nbreak = 'Pause'\n"), "Pause");
}

TEST(PageSet, MistakesAreNamed) {
    EXPECT_THAT(pages_refusal("[consent]\ntext = 'x'\nagree = 'y'\ndecline = 'n'\n"),
                HasSubstr("consent.version"));
    EXPECT_THAT(pages_refusal("[[questionnaire]]\nname = 'a b'\n"), HasSubstr("small letters"));
    EXPECT_THAT(pages_refusal("[[questionnaire]]\nname = 'consent'\n"), HasSubstr("is used twice"));
    EXPECT_THAT(pages_refusal("[[questionnaire]]\nname = 'ease'\n"), HasSubstr("at least one"));
    EXPECT_THAT(pages_refusal(std::string(kForm) + "id = 'time_utc'\ntext = 'x'\n"),
                HasSubstr("is used twice"));
    EXPECT_THAT(pages_refusal(std::string(kForm) + "id = 'q'\n"), HasSubstr("text"));
    EXPECT_THAT(
        pages_refusal(std::string(kForm) + "id = 'q'\ntext = 'x'\nkind = 'choice'\nchoices = ['one']\n"),
        HasSubstr("2 to 9"));
    EXPECT_THAT(pages_refusal(std::string(kForm) + "id = 'q'\ntext = 'x'\nkind = 'likert'\nto = 40\n"),
                HasSubstr("2 to 9 points"));
    EXPECT_THAT(pages_refusal(std::string(kForm) + "id = 'q'\ntext = 'x'\nstep = 7\n"), HasSubstr("divide"));
    EXPECT_THAT(pages_refusal(std::string(kForm) + "id = 'q'\ntext = 'x'\nkind = 'likert'\nfrom = 0\n"),
                HasSubstr("has no effect"));
}

TEST(PageSet, AScriptFromRightToLeftIsRefusedWithAReason) {
    for (const char* text : {"שלום", "مرحبا", "a \u202E b", "\U0001E900"})
        EXPECT_NE(right_to_left(text), 0U) << text;
    for (const char* text : {"", "Größe, perché, naïve", "Ωμέγα", "針", "Привет"})
        EXPECT_EQ(right_to_left(text), 0U) << text;
    EXPECT_THAT(
        pages_refusal("[instructions]\nready = 'שלום'\n"),
        testing::AllOf(HasSubstr("instructions.ready"), HasSubstr("U+05E9"), HasSubstr("right to left")));
    EXPECT_THAT(pages_refusal(std::string(kForm) +
                              "id = 'q'\ntext = 'x'\nkind = 'choice'\nchoices = ['one', 'مرحبا']\n"),
                HasSubstr("right to left"));
}

Question question_of(QuestionKind kind, double from, double to, double step = 1) {
    Question question;
    question.kind = kind;
    question.from = from;
    question.to = to;
    question.step = step;
    return question;
}

TEST(QuestionForm, GivesNothingBeforeSomethingIsChosen) {
    const Question scale = question_of(QuestionKind::kScale, 0, 100, 5);
    QuestionForm form;
    EXPECT_FALSE(form.given());
    form.show(3, &scale);
    EXPECT_FALSE(form.given());
    form.move(1);
    EXPECT_FALSE(form.given()) << "the end of the text has not been seen";
    form.read_to_end();
    EXPECT_EQ(form.given()->value, 50) << "an arrow key begins in the middle";
    form.move(-1);
    EXPECT_EQ(form.given()->value, 45);
    form.choose(73);
    EXPECT_EQ(form.given()->value, 75);
    form.choose(1e9);
    EXPECT_EQ(form.given()->question, 3U);
    EXPECT_EQ(form.given()->value, 100);
    form.show(3, &scale);
    EXPECT_TRUE(form.given()) << "the page is repeated all the time";
    form.show(4, &scale);
    EXPECT_FALSE(form.given());
    form.show(0, nullptr);
    form.move(1);
    form.type(1);
    EXPECT_FALSE(form.given());
}

TEST(QuestionForm, DigitsChooseOrMakeANumber) {
    const Question likert = question_of(QuestionKind::kLikert, 1, 7);
    QuestionForm form;
    form.show(1, &likert);
    form.read_to_end();
    form.type(8);
    form.type(0);
    EXPECT_FALSE(form.given());
    form.type(6);
    EXPECT_EQ(form.given()->value, 6);
    const Question age = question_of(QuestionKind::kNumber, 18, 89);
    form.show(2, &age);
    form.read_to_end();
    form.type(3);
    EXPECT_FALSE(form.given()) << "3 is too young";
    form.type(1);
    EXPECT_EQ(form.given()->value, 31);
    form.type(5);
    EXPECT_EQ(form.given()->value, 89) << "315 is more than the most";
    form.clear();
    EXPECT_FALSE(form.given());
    form.type(1);
    EXPECT_FALSE(form.given()) << "on the way to 18";
    form.clear();
    for (const int digit : {9, 0}) form.type(digit);
    EXPECT_EQ(form.given()->value, 89) << "of somebody who is 90";
    const Question below = question_of(QuestionKind::kNumber, -20, 20);
    form.show(3, &below);
    form.move(1);
    form.type(5);
    EXPECT_EQ(form.value(), 5) << "-20, and then a number of its own";
}

}  // namespace
}  // namespace thimble
