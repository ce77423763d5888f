// Consent, questionnaires, attention trials and corrections of a participant session, with trials that are over at once.
#include "session/participant/questions.hpp"

#include <algorithm>
#include <deque>
#include <future>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "session/participant/corrections.hpp"
#include "session/participant/counted_trials.hpp"
#include "session/participant/participant_session.hpp"
#include "tests/refusal.hpp"
#include "tests/unit/participant/bids_validator.hpp"
#include "tests/unit/participant/short_sessions.hpp"
#include "tests/unit/participant/written_lines.hpp"

namespace thimble {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kPages =
    "[consent]\nversion = 'v2'\ntext = 'You take part.'\nagree = 'yes'\ndecline = 'no'\n"
    "[[questionnaire]]\nname = 'about'\nwhen = 'start'\n"
    "[[questionnaire.question]]\nid = 'age'\ntext = 'How old?'\nkind = 'number'\n"
    "[[questionnaire]]\nname = 'load'\n"
    "[[questionnaire.question]]\nid = 'effort'\ntext = 'How hard?'\nstep = 5\nlow = 'little'\nhigh = 'much'\n"
    "[[questionnaire.question]]\nid = 'hand'\ntext = 'Which?'\nkind = 'choice'\nchoices = ['left', 'right']\n"
    "[[questionnaire]]\nname = 'end'\nwhen = 'end'\n"
    "[[questionnaire.question]]\nid = 'good'\ntext = 'Good?'\nkind = 'likert'\n";

// A participant who gives the next of `answers` to each question.
class AnsweredTrials final : public TrialRunner {
  public:
    void prepare() override {}
    std::uint32_t last_number() const override { return 0; }
    TrialRecord run(const TrialConditions& conditions, std::uint32_t, const std::filesystem::path&) override {
        events.push_back(fmt::format("trial {}", conditions.trial));
        asked = 0;
        TrialRecord record = sine_record(0.003, 0.001, 4);
        record.conditions = conditions;
        clock += std::chrono::seconds{10};
        return record;
    }
    void show(const Page& page) override {
        if (page.kind == PageKind::kQuestion && page.trial != asked)
            events.push_back(fmt::format("question {}", page.trial));
        asked = page.kind == PageKind::kQuestion ? page.trial : 0;
        shown = page;
        if (stop_at != 0 && asked == stop_at) stopped = true;
    }
    bool take_go_on() override { return false; }
    std::optional<double> take_answer() override {
        if (answers.empty()) return std::nullopt;
        const double answer = answers.front();
        answers.pop_front();
        return answer;
    }
    void idle(Duration limit) override { clock += limit; }
    SessionTime now() const override { return clock; }
    std::string problem() const override { return {}; }
    std::string stop_text() const override { return stopped ? stopped_by : std::string(); }
    void release_stop() override { stopped_by.clear(); }

    std::deque<double> answers;
    std::vector<std::string> events;
    std::uint32_t asked = 0, stop_at = 0;  // the question that a stop comes with
    std::string stopped_by;
    bool stopped = false;
    Page shown;
    SessionTime clock{};
};

class Questions : public testing::Test {
  protected:
    Questions() {
        const ConfigFile file = ConfigFile::parse(kPages, "pages.toml");
        file.read_all([&] { pages_ = read_page_set(file); });
    }

    ParticipantSessionResult run(const std::string& more = "", LineSource* lines = nullptr,
                                 LineSource* requests = nullptr) {
        const SystemSettings settings = short_settings(more);
        if (!is_table(dataset_.order(2))) {
            dataset_.open(SubjectKind::kHuman, settings.dataset);
            write_order(dataset_.order(2), plan_order(settings, 2));
            add_participant(dataset_, 2, SubjectKind::kHuman, {});
        }
        ParticipantSessionOptions options{dataset_, 2, *settings.protocol, nullptr, false, nullptr, say_};
        options.lines = lines;
        options.requests = requests;
        options.pages = &pages_;
        options.realtime_ns = [] { return std::int64_t{1'764'109'807'000'000'000}; };
        return ParticipantSession(std::move(options), trials_).run();
    }
    std::string phenotype(const std::string& file) const {
        return read_text(dataset_.folder() / "phenotype" / file);
    }

    TemporaryDirectory directory_;
    Dataset dataset_{directory_ / "d"};
    PageSet pages_;
    AnsweredTrials trials_;
    std::vector<std::string> said_;
    const std::function<void(const std::string&)> say_ = [this](const std::string& line) {
        said_.push_back(line);
    };
};

TEST_F(Questions, StandBeforeBetweenAndAfterBlocks) {
    trials_.answers = {31, 45, 2, 50, 1, 7};
    EXPECT_EQ(run().code, ExitCode::kOk);
    EXPECT_THAT(trials_.events,
                ElementsAre("question 2", "trial 1001", "trial 1", "trial 2", "question 3", "question 4",
                            "trial 3", "trial 4", "question 3", "question 4", "question 5"));
    EXPECT_EQ(phenotype("about.tsv"), "participant_id\ttime_utc\tage\nsub-02\t2025-11-25T22:30:07Z\t31\n");
    EXPECT_THAT(phenotype("load_block1.tsv"), HasSubstr("sub-02\t2025-11-25T22:30:07Z\t45\t2\n"));
    EXPECT_THAT(phenotype("load_block2.tsv"), HasSubstr("\t50\t1\n"));
    EXPECT_THAT(phenotype("end.tsv"), HasSubstr("\t7\n"));
    EXPECT_THAT(phenotype("load_block1.json"), AllOf(HasSubstr("How hard?"), HasSubstr("\"1\": \"left\"")));
    trials_.events.clear();
    EXPECT_EQ(run().code, ExitCode::kOk);
    EXPECT_TRUE(trials_.events.empty()) << "nothing is asked twice";
}

TEST_F(Questions, AnAnswerThatTheQuestionHasNotIsNotTaken) {
    trials_.answers = {-4, 31.5, 31, 47, 45, 3, 2, 50, 1, 0, 7};
    run();
    EXPECT_THAT(phenotype("about.tsv"), HasSubstr("\t31\n"));
    EXPECT_THAT(phenotype("load_block1.tsv"), HasSubstr("\t45\t2\n"));
}

TEST_F(Questions, TheExperimenterLeavesOneOutOrStops) {
    WrittenLines stops({"what?", "s", "", "", "", "q"});
    const auto stopped = run("", &stops);
    EXPECT_NE(stopped.code, ExitCode::kOk);
    EXPECT_THAT(phenotype("about.tsv"), HasSubstr("\tn/a\n"));
    EXPECT_THAT(said_, Contains(HasSubstr("s: skip this question")));
    EXPECT_EQ(phenotype("load_block1.tsv"),
              "participant_id\ttime_utc\teffort\thand\nsub-02\tn/a\tn/a\tn/a\n");
    trials_.events.clear();
    trials_.answers = {45, 2, 50, 1, 7};
    run();
    EXPECT_EQ(trials_.events.front(), "question 3") << "the questionnaire that was cut comes again";
}

TEST_F(Questions, ARejectedTrialPutsOffTheQuestionsOfItsBlock) {
    trials_.answers = {31};
    WrittenLines stops({"", "", "", "r", "r sneezed", "", "s", "x late", "s", "q"});
    EXPECT_NE(run("", &stops).code, ExitCode::kOk);
    EXPECT_THAT(trials_.events, ElementsAre("question 2", "trial 1001", "trial 1", "trial 2", "question 3",
                                            "trial 2", "question 3", "question 4"));
    EXPECT_THAT(said_, AllOf(Contains("a reason is missing, e.g.: r sneezed"),
                             Contains("trial 3 is rejected: sneezed"),
                             Contains(HasSubstr("questionnaire load comes after the repeat")),
                             Contains("trial 3 is excluded: late")));
    EXPECT_THAT(phenotype("load_block1.tsv"), HasSubstr("Z\tn/a\tn/a\n"));
    const auto include = [&] { include_trial(dataset_.folder(), "P02", 3, {"LS", "not late", ""}); };
    include();
    EXPECT_THAT(refusal(include, ExitCode::kUsage),
                HasSubstr("is included already: record 4 was run instead of record 3"));
}

TEST_F(Questions, HearAViewTheInputsEndAndAnEmergencyStop) {
    WrittenLines view({"q"});
    EXPECT_EQ(run("", nullptr, &view).code, ExitCode::kRunFailed);
    WrittenLines ends({"s", "", "", ""});
    EXPECT_EQ(run("", &ends).code, ExitCode::kRunFailed);
    EXPECT_EQ(trials_.events.back(), "question 3");
    EXPECT_THAT(said_, Contains(HasSubstr("the input has ended")));
    trials_.stopped_by = "emergency stop (master): a key";
    trials_.stop_at = 3;
    WrittenLines release({"release", "s", "q"});
    EXPECT_EQ(run("", &release).code, ExitCode::kRunFailed);
    EXPECT_THAT(said_, Contains("emergency stop (master): a key, or type 'release'"));
    EXPECT_THAT(said_, Contains("released"));
    EXPECT_EQ(trials_.events.back(), "question 4");
}

TEST_F(Questions, TheInputsEndIsAlsoHeardWhileAStopHolds) {
    trials_.stopped_by = "emergency stop (master): a key";
    trials_.stopped = true;
    WrittenLines nothing({});
    EXPECT_EQ(await_release({trials_, &nothing, nullptr, say_}, {}), Asked::kStopped);
    EXPECT_THAT(said_, Contains(HasSubstr("the input has ended")));
}

TEST_F(Questions, ConsentHasAVersionAndATime) {
    trials_.answers = {3, 2};
    EXPECT_EQ(ask_consent({trials_, nullptr, nullptr, say_}, pages_), Consent::kDeclined);
    trials_.answers = {1};
    EXPECT_EQ(ask_consent({trials_, nullptr, nullptr, say_}, pages_), Consent::kGiven);
    WrittenLines lines({"s", "q"});
    EXPECT_EQ(ask_consent({trials_, &lines, nullptr, say_}, pages_), Consent::kStopped);
    EXPECT_FALSE(has_consented(dataset_, *pages_.consent, 2));
    write_consent(dataset_, *pages_.consent, 2, utc_text(1'764'109'807'000'000'000));
    EXPECT_TRUE(has_consented(dataset_, *pages_.consent, 2));
    EXPECT_FALSE(has_consented(dataset_, *pages_.consent, 3));
    EXPECT_EQ(phenotype("consent.tsv"),
              "participant_id\ttime_utc\tconsent\tversion\nsub-02\t2025-11-25T22:30:07Z\tyes\tv2\n");
    pages_.consent->version = "v3";
    EXPECT_FALSE(has_consented(dataset_, *pages_.consent, 2)) << "another text";
    add_participant(dataset_, 3, SubjectKind::kHuman, {});
    open_phenotype(dataset_, pages_, 1);
    pages_.consent->version = "n/a";
    EXPECT_FALSE(has_consented(dataset_, *pages_.consent, 3)) << "the line says that nothing is known";
}

TEST_F(Questions, AnEmergencyStopInTheConsentPageIsSaidAtOnce) {
    trials_.stopped_by = "emergency stop (visual): a key";
    trials_.stop_at = 1;
    WrittenLines lines({"", "release", "what?", "q"});
    Asker asker{trials_, &lines, nullptr, say_};
    asker.hold = [&] { return await_release(asker, {}); };
    EXPECT_EQ(ask_consent(asker, pages_), Consent::kStopped);
    EXPECT_THAT(said_, ElementsAre(HasSubstr("consent, version v2"),
                                   "emergency stop (visual): a key, or type 'release'",
                                   "release the stop before anything begins", "released",
                                   "the participant answers at the screen; q: quit"));
    EXPECT_EQ(trials_.shown.kind, PageKind::kQuestion) << "it comes back";
}

TEST_F(Questions, CarryTheChecksumOfTheirPageSet) {
    const std::uint32_t ours = pages_.checksum();
    trials_.answers = {1};
    ask_consent({trials_, nullptr, nullptr, say_}, pages_);
    EXPECT_EQ(trials_.shown.trials, ours);
    const auto differs = [&](const std::function<void(PageSet&)>& change) {
        PageSet other = pages_;
        change(other);
        return other.checksum() != ours;
    };
    EXPECT_TRUE(differs([](PageSet& p) { p.consent->text = "You take part!"; }));
    EXPECT_TRUE(differs([](PageSet& p) { p.questionnaires[1].questions[0].text = "How heavy?"; }));
    EXPECT_TRUE(differs([](PageSet& p) { p.questionnaires[1].questions[0].step = 1; }));
    EXPECT_TRUE(differs([](PageSet& p) { std::swap(p.consent->agree, p.consent->decline); }));
    EXPECT_FALSE(differs([](PageSet&) {}));
}

TEST_F(Questions, ChangedQuestionsAreNoticedBeforeAnythingIsWritten) {
    check_phenotype(dataset_, pages_, 2);
    EXPECT_FALSE(std::filesystem::exists(dataset_.folder()));
    trials_.answers = {31, 45, 2, 50, 1, 7};
    run();
    check_phenotype(dataset_, pages_, 2);
    pages_.questionnaires[1].questions.pop_back();
    EXPECT_THAT(refusal([&] { check_phenotype(dataset_, pages_, 2); }),
                HasSubstr("the questions of questionnaire load differ from those in this dataset"));
}

TEST_F(Questions, TwoSessionsInOneDatasetKeepEachOthersAnswers) {
    dataset_.open(SubjectKind::kHuman, {});
    const auto answer = [this](std::uint32_t first) {
        for (std::uint32_t i = 0; i < 40; i += 2)
            write_answers(dataset_, pages_.questionnaires[0], {first + i, 0, "now", {31.0}});
    };
    auto other = std::async(std::launch::async, answer, 1U);
    answer(2);
    other.get();
    const std::string lines = phenotype("about.tsv");
    EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 1 + 40);
}

TEST_F(Questions, ATableThatLacksNobodyIsNotReplaced) {
    dataset_.open(SubjectKind::kHuman, {});
    add_participant(dataset_, 2, SubjectKind::kHuman, {});
    open_phenotype(dataset_, pages_, 1);
    const auto table = dataset_.folder() / "phenotype" / "about.tsv", same = directory_ / "same";
    std::filesystem::create_hard_link(table, same);
    open_phenotype(dataset_, pages_, 1);
    EXPECT_TRUE(std::filesystem::equivalent(table, same));
    add_participant(dataset_, 3, SubjectKind::kHuman, {});
    open_phenotype(dataset_, pages_, 1);
    EXPECT_THAT(phenotype("about.tsv"), HasSubstr("sub-03\tn/a\tn/a\n"));
}

TEST_F(Questions, WhoHasAgreedOrIsInTheTableIsKnown) {
    EXPECT_FALSE(knows_person(dataset_, 2));
    write_consent(dataset_, *pages_.consent, 2, utc_text(1'764'109'807'000'000'000));
    EXPECT_TRUE(knows_person(dataset_, 2));
    add_participant(dataset_, 3, SubjectKind::kHuman, {});
    EXPECT_TRUE(knows_person(dataset_, 3));
    EXPECT_FALSE(knows_person(dataset_, 4));
}

TEST_F(Questions, AttentionTrialsAreFlaggedAndNotAnalysed) {
    pages_ = {};
    run("attention_every = 3\nattention_limit_s = 1\n");
    EXPECT_THAT(trials_.events,
                ElementsAre("trial 1001", "trial 1", "trial 2", "trial 3", "trial 2001", "trial 4"));
    EXPECT_THAT(said_, Contains("attention trial 5: failed"));
    const CountedTrials counted = counted_trials(dataset_);
    EXPECT_EQ(counted.rows.size(), 4U);
    EXPECT_EQ(counted.missing, 0U);
    EXPECT_THAT(describe(counted), AllOf(Contains("left out: 1 attention trials"),
                                         Contains("attention: sub-02 passed 0 of 1 trials, not 5")));
    std::filesystem::remove(dataset_.attention());
    run("attention_every = 3\nattention_limit_s = 1\n");
    run("attention_every = 3\nattention_limit_s = 1\n");
    EXPECT_THAT(said_, Contains("attention trial 5: failed").Times(2)) << "judged anew, once";
    const auto results = read_attention(dataset_.attention());
    ASSERT_EQ(results.size(), 1U);
    AttentionResult again = results[0];
    again.passed = true;
    add_attention(dataset_.attention(), again);
    EXPECT_THAT(describe(counted_trials(dataset_)), Contains("attention: sub-02 passed 1 of 1 trials"));
    exclude_trial(dataset_.folder(), "P02", 5, {"LS", "phone rang", ""});
    EXPECT_THAT(describe(counted_trials(dataset_)), AllOf(Contains("  sub-02 trial 5 (record 5): phone rang"),
                                                          Not(Contains(HasSubstr("attention")))));
}

// A power cut came while a line was written.
TEST_F(Questions, HalfALineOfATableStopsNoSession) {
    pages_ = {};
    const auto exclude = [&] { exclude_trial(dataset_.folder(), "P02", 2, {"LS", "asleep", ""}); };
    run("attention_every = 3\n");
    exclude();
    for (const auto& file : {dataset_.exclusions(), dataset_.attention()})
        std::filesystem::resize_file(file, std::filesystem::file_size(file) - 2);
    EXPECT_EQ(run("attention_every = 3\n").code, ExitCode::kOk);
    EXPECT_EQ(read_attention(dataset_.attention()).size(), 1U) << "judged anew";
    exclude();
    EXPECT_EQ(read_exclusions(dataset_.exclusions()).size(), 1U);
}

TEST_F(Questions, ABlindedTerminalNamesNeitherModalityNorResult) {
    pages_ = {};
    run("blinded = true\nattention_every = 3\n");
    for (const std::string& line : said_)
        EXPECT_THAT(line, AllOf(Not(HasSubstr("HF")), Not(HasSubstr("CF")), Not(HasSubstr("penetration")),
                                Not(HasSubstr("attention")), Not(HasSubstr("experiment"))));
    EXPECT_THAT(said_, Contains(HasSubstr("trial 1 of 6 (practice): completed")));
    EXPECT_THAT(said_, Contains(HasSubstr("trial 2 of 6: completed")));
}

TEST_F(Questions, CorrectionsLeaveALineAndTheAnalysisHonoursThem) {
    pages_ = {};
    run();
    const CorrectionNote note{"LS", "phone rang", "2026-11-25T10:00:00Z"};
    const auto counted = [&] { return counted_trials(dataset_).rows.size(); };
    EXPECT_EQ(counted(), 4U);
    exclude_trial(dataset_.folder(), "P02", 3, note);
    EXPECT_EQ(counted(), 3U);
    EXPECT_THAT(refusal([&] { exclude_trial(dataset_.folder(), "P02", 3, note); }, ExitCode::kUsage),
                HasSubstr("is excluded already: phone rang"));
    include_trial(dataset_.folder(), "P02", 3, {"LS", "wrong trial", "2026-11-25T10:01:00Z"});
    EXPECT_EQ(counted(), 4U);
    EXPECT_EQ(correct_person(dataset_.folder(), "P02", "age", "92", note), "89+");
    EXPECT_EQ(person_field(dataset_, 2, "age"), "89+");
    EXPECT_EQ(read_text(dataset_.corrections()),
              "time_utc\tby\tparticipant_id\titem\tbefore\tafter\treason\n"
              "2026-11-25T10:00:00Z\tLS\tsub-02\ttrial 3 (record 3)\tincluded\texcluded\tphone rang\n"
              "2026-11-25T10:01:00Z\tLS\tsub-02\ttrial 3 (record 3)\texcluded\tincluded\twrong trial\n"
              "2026-11-25T10:00:00Z\tLS\tsub-02\tage\tn/a\t89+\tphone rang\n");
    EXPECT_THAT(describe(counted_trials(dataset_)),
                Contains(HasSubstr("corrected after the sessions: 3 times")));
    for (const auto& wrong : {std::pair{"consent", "yes"}, std::pair{"sex", "x"}, std::pair{"age", "0"}}) {
        const auto change = [&] {
            correct_person(dataset_.folder(), "P02", wrong.first, wrong.second, note);
        };
        EXPECT_NE(refusal(change, ExitCode::kUsage), "nothing was refused") << wrong.first;
    }
    const auto silent = [&] { exclude_trial(dataset_.folder(), "P02", 2, {"LS", " ", ""}); };
    EXPECT_THAT(refusal(silent, ExitCode::kUsage), HasSubstr("only with a reason: give --reason"));
}

// npm's bids-validator over a whole dataset with consent, questionnaires, attention trials and a correction.
TEST_F(Questions, BidsValidatorFindsNoErrorInADatasetWithAnswers) {
    if (bids_validator().empty())
        GTEST_SKIP() << "bids-validator is not installed: deploy/install-validators does that where "
                        "there is npm (package npm)";
    trials_.answers = {31, 45, 2, 50, 1, 7};
    run("attention_every = 3\n[dataset]\nauthors = ['Somebody']\nlicense = 'CC0'\n");
    write_consent(dataset_, *pages_.consent, 2, utc_text(1'764'109'807'000'000'000));
    correct_person(dataset_.folder(), "P02", "age", "32", {"LS", "typing error", "2026-11-25T10:00:00Z"});
    // This participant came before there were questionnaires.
    add_participant(dataset_, 1, SubjectKind::kHuman, {});
    RecordTable(dataset_.records(1));
    open_phenotype(dataset_, pages_, 2);
    const auto found = judged_by_bids(dataset_.folder(), directory_ / "said");
    ASSERT_TRUE(found.is_object()) << read_text(directory_ / "said.err");
    EXPECT_EQ(found["issues"]["errors"], nlohmann::json::array());
}

}  // namespace
}  // namespace thimble
