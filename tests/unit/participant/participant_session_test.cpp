// A whole participant session with trials that are over at once and an experimenter whose lines are written beforehand.
#include "session/participant/participant_session.hpp"

#include <algorithm>
#include <deque>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "tests/unit/participant/short_sessions.hpp"
#include "tests/unit/participant/written_lines.hpp"

namespace thimble {
namespace {

using std::chrono::seconds;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

class InstantTrials final : public TrialRunner {
  public:
    void prepare() override { ++prepared; }
    std::uint32_t last_number() const override { return seen; }
    TrialRecord run(const TrialConditions& conditions, std::uint32_t number,
                    const std::filesystem::path& trajectory) override {
        std::filesystem::create_directories(trajectory.parent_path());
        std::ofstream(trajectory) << "samples\n";
        numbers.push_back(number);
        seen = number;
        TrialRecord record = sine_record(0.003, 0.001, 4);
        record.conditions = conditions;
        if (!outcomes.empty()) {
            record.reason = outcomes.front();
            outcomes.pop_front();
        }
        clock += seconds{10};
        if (numbers.size() == stop_after) stop = true;
        if (is_stop(record.reason)) stopped_by = "emergency stop (master): a key";
        return record;
    }
    void show(const Page& page) override {
        if (pages.empty() || pages.back().kind != page.kind || pages.back().trial != page.trial)
            pages.push_back(page), turned = clock;
    }
    // Presses on every page that waits, once it has been read; also on those that do not.
    bool take_go_on() override { return presses && clock - turned >= seconds{1}; }
    void idle(Duration limit) override { clock += limit; }
    SessionTime now() const override { return clock; }
    std::string problem() const override { return "the cable"; }
    std::string stop_text() const override { return stopped_by; }
    void release_stop() override { stopped_by.clear(); }

    std::deque<EndReason> outcomes;
    std::vector<std::uint32_t> numbers;
    std::vector<Page> pages;  // without repetitions
    std::uint32_t seen = 0;
    std::size_t stop_after = 0;
    std::string stopped_by;  // until released
    int prepared = 0;
    SessionTime clock{}, turned{};
    bool presses = false;
    std::atomic<bool> stop = false;
};

// Says its line once so many trials have been run.
class WishAfter final : public LineSource {
  public:
    WishAfter(const InstantTrials& trials, std::size_t after, std::string line)
        : trials_(trials), after_(after), line_(std::move(line)) {}
    std::optional<std::string> take_line() override {
        if (said_ || trials_.numbers.size() < after_) return std::nullopt;
        said_ = true;
        return line_;
    }
    bool ended() const override { return false; }

  private:
    const InstantTrials& trials_;
    std::size_t after_;
    std::string line_;
    bool said_ = false;
};

// Enter, again and again.
class HeldEnter final : public LineSource {
  public:
    std::optional<std::string> take_line() override { return std::string(); }
    void forget_enter() override { ++forgotten; }
    bool ended() const override { return false; }

    int forgotten = 0;
};

class ParticipantSessionTest : public testing::Test {
  protected:
    ParticipantSessionTest() : dataset_(directory_ / "d"), settings_(*short_settings().protocol) {
        settings_.break_minimum = seconds{30};
        write_order(dataset_.order(2), plan_order(short_settings(), 2));  // practice | 2, 3 | 4, 5
    }

    ParticipantSessionResult run_to_end(LineSource* lines = nullptr) {
        ParticipantSessionOptions options{
            dataset_, 2, settings_, lines, rests_, &trials_.stop, [this](const std::string& line) {
                said_.push_back(line);
            }};
        options.requests = wishes_;
        options.paused = paused_;
        options.subject_goes_on = subject_goes_on_;
        return ParticipantSession(std::move(options), trials_).run();
    }
    std::vector<std::uint32_t> positions() const {
        std::vector<std::uint32_t> list;
        for (const DatasetRecord& record : read_records(dataset_.records(2))) list.push_back(record.position);
        return list;
    }
    std::string table() const { return read_text(dataset_.records(2)); }

    TemporaryDirectory directory_;
    Dataset dataset_;
    ProtocolSettings settings_;
    InstantTrials trials_;
    std::vector<std::string> said_;
    bool rests_ = true;
    LineSource* wishes_ = nullptr;
    bool subject_goes_on_ = false;
    std::function<bool()> paused_;
};

TEST_F(ParticipantSessionTest, RunsTheOrderAndRests) {
    const ParticipantSessionResult result = run_to_end();
    EXPECT_EQ(result.code, ExitCode::kOk) << result.problem;
    EXPECT_EQ(result.trials_begun, 5U);
    EXPECT_THAT(positions(), ElementsAre(1, 2, 3, 4, 5));
    EXPECT_THAT(trials_.numbers, ElementsAre(1, 2, 3, 4, 5));
    EXPECT_THAT(said_, Contains(HasSubstr(settings_.break_text)).Times(2));
    EXPECT_GE(trials_.clock - SessionTime{}, seconds{5 * 10 + 2 * 30});
}

TEST_F(ParticipantSessionTest, TheScreenSaysWhatComesNext) {
    run_to_end();
    using enum PageKind;
    std::vector<PageKind> kinds;
    std::vector<std::uint32_t> trials;
    for (const Page& page : trials_.pages) {
        kinds.push_back(page.kind);
        trials.push_back(page.trial);
        EXPECT_EQ(page.trials, 5U);
        EXPECT_LE(page.remaining_s, 30);
    }
    EXPECT_THAT(kinds, ElementsAre(kWelcome, kBreak, kReady, kReady, kBreak, kReady, kReady, kDone));
    EXPECT_THAT(trials, ElementsAre(1, 2, 2, 3, 4, 4, 5, 0));
}

TEST_F(ParticipantSessionTest, AParticipantAloneBeginsEachTrialAndTheEndComesByItself) {
    subject_goes_on_ = trials_.presses = true;
    EXPECT_EQ(run_to_end().code, ExitCode::kOk);
    EXPECT_THAT(positions(), ElementsAre(1, 2, 3, 4, 5));
    EXPECT_THAT(said_, Contains(HasSubstr("The participant continues at the screen")).Times(testing::Ge(5)));
    EXPECT_GE(trials_.clock - SessionTime{}, seconds{5 * 10 + 2 * 30}) << "a key shortens no break";
}

TEST_F(ParticipantSessionTest, WithoutTheProtocolsWordAKeyDoesNothing) {
    trials_.presses = true;
    WrittenLines lines({"", "q"});
    EXPECT_EQ(run_to_end(&lines).code, ExitCode::kRunFailed);
    EXPECT_THAT(positions(), ElementsAre(1));
}

// After the last trial the experimenter is asked, whatever the participant presses.
TEST_F(ParticipantSessionTest, BothMayGoOnAndTheLastWordIsTheExperimenters) {
    rests_ = false;
    subject_goes_on_ = trials_.presses = true;
    WishAfter reject(trials_, 5, "r slipped");
    trials_.stop_after = 6;
    EXPECT_EQ(run_to_end(&reject).code, ExitCode::kRunFailed);
    EXPECT_THAT(positions(), ElementsAre(1, 2, 3, 4, 5, 5));
}

TEST_F(ParticipantSessionTest, AfterEachTrialItForgetsTheEnterOfBothSources) {
    settings_.break_every = 0;
    HeldEnter enter;
    TwoLineSources both(enter, enter);
    EXPECT_EQ(run_to_end(&both).code, ExitCode::kOk);
    EXPECT_EQ(enter.forgotten, 2 * 5);
}

TEST_F(ParticipantSessionTest, VirtualSubjectsDoNotRest) {
    rests_ = false;
    run_to_end();
    EXPECT_EQ(trials_.clock - SessionTime{}, seconds{50});
}

TEST_F(ParticipantSessionTest, AMissingOrderIsNeverMadeUp) {
    std::filesystem::remove(dataset_.order(2));
    EXPECT_THROW(run_to_end(), Error);
    EXPECT_TRUE(trials_.numbers.empty());
}

TEST_F(ParticipantSessionTest, GoesOnWhereItWasStoppedWithTheSameBytes) {
    run_to_end();
    const std::string whole = table();
    for (std::size_t stop_after = 1; stop_after <= 4; ++stop_after) {
        std::filesystem::remove(dataset_.records(2));
        trials_.seen = 0;  // new programs
        trials_.stop_after = trials_.numbers.size() + stop_after;
        const ParticipantSessionResult first = run_to_end();
        EXPECT_EQ(first.code, ExitCode::kRunFailed);
        EXPECT_EQ(first.records, stop_after);
        EXPECT_EQ(trials_.pages.back().kind, PageKind::kPaused);
        EXPECT_EQ(trials_.pages.back().trial, stop_after + 1);
        EXPECT_THAT(first.problem, HasSubstr("--resume"));
        trials_.stop = false;
        trials_.seen = 0;
        EXPECT_EQ(run_to_end().code, ExitCode::kOk);
        EXPECT_EQ(table(), whole) << stop_after;
    }
    const std::size_t trials = trials_.numbers.size();
    EXPECT_EQ(run_to_end().code, ExitCode::kOk);  // complete
    EXPECT_EQ(trials_.numbers.size(), trials);
}

TEST_F(ParticipantSessionTest, NodesThatGoOnRunningNeverSeeANumberTwice) {
    trials_.seen = 3;  // the last one was cut off: no record
    run_to_end();
    EXPECT_THAT(trials_.numbers, ElementsAre(4, 5, 6, 7, 8));
}

TEST_F(ParticipantSessionTest, TheSamplesOfATrialThatWasCutOffAreKept) {
    const auto folder = dataset_.source(2) / "trajectories";
    const OrderEntry first = read_order(dataset_.order(2), 2).front();
    const auto name =
        fmt::format("record001_experiment1_trial1001_{}_0ms", to_string(first.conditions.modality));
    std::filesystem::create_directories(folder);
    std::ofstream(folder / (name + ".csv")) << "half a trial";
    run_to_end();
    EXPECT_EQ(read_text(folder / (name + "_cut1.csv")), "half a trial");
    EXPECT_EQ(read_text(folder / (name + ".csv")), "samples\n");
}

TEST_F(ParticipantSessionTest, FailuresAreRepeatedAtTheEndOfTheirBlock) {
    trials_.outcomes = {EndReason::kCompleted, EndReason::kTimeout, EndReason::kPeerLost};
    EXPECT_EQ(run_to_end().repeats, 2U);
    EXPECT_THAT(positions(), ElementsAre(1, 2, 3, 2, 3, 4, 5));
    const auto records = read_records(dataset_.records(2));
    EXPECT_EQ(records[1].row.reason, EndReason::kTimeout);  // its line stays
    EXPECT_EQ(records[3].repeat_of, 2U);
    EXPECT_EQ(records[3].repeat_reason, "timeout");
    EXPECT_EQ(records[4].repeat_of, 3U);
}

TEST_F(ParticipantSessionTest, GivesUpWhenPeersAreLostAgainAndAgain) {
    trials_.outcomes.assign(9, EndReason::kPeerLost);
    const ParticipantSessionResult result = run_to_end();
    EXPECT_EQ(result.code, ExitCode::kNetwork);
    EXPECT_EQ(result.records, 3U);
    EXPECT_THAT(result.problem, HasSubstr("the cable"));
    EXPECT_THAT(said_, Contains("the cable").Times(3)) << "at each trial";
}

TEST_F(ParticipantSessionTest, GivesUpOnADiskOrAGuardWithoutNamingTheNetwork) {
    trials_.outcomes = {EndReason::kDeviceFault, EndReason::kDeviceFault, EndReason::kSafetyStop};
    EXPECT_EQ(run_to_end().code, ExitCode::kRunFailed);
}

TEST_F(ParticipantSessionTest, TheExperimenterRejectsAndExcludes) {
    settings_.break_minimum = seconds{0};
    // Before each trial a line is asked for; what marks the last trial comes before its Enter.
    WrittenLines lines({"r too early", "", "", "r sneezed", "", "x phone rang", "", "", "", "", ""});
    EXPECT_EQ(run_to_end(&lines).code, ExitCode::kOk);
    EXPECT_THAT(said_, Contains(HasSubstr("there is no trial yet")));
    EXPECT_THAT(positions(), ElementsAre(1, 2, 3, 2, 4, 5));
    const auto marks = read_exclusions(dataset_.exclusions());
    ASSERT_EQ(marks.size(), 2U);
    EXPECT_EQ(marks[0].kind, ExclusionKind::kRejected);
    EXPECT_EQ(marks[0].record, 2U);
    EXPECT_EQ(marks[0].reason, "sneezed");
    EXPECT_EQ(marks[1].kind, ExclusionKind::kExcluded);
    EXPECT_EQ(marks[1].record, 3U);
    const DatasetRecord again = read_records(dataset_.records(2))[3];
    EXPECT_EQ(again.repeat_of, 2U);
    EXPECT_EQ(again.repeat_reason, "sneezed");
}

TEST_F(ParticipantSessionTest, TheLastTrialCanBeRejectedToo) {
    rests_ = false;
    WrittenLines lines({"", "", "", "", "", "r slipped", ""});  // its end is no interruption any more
    EXPECT_EQ(run_to_end(&lines).code, ExitCode::kOk);
    EXPECT_THAT(positions(), ElementsAre(1, 2, 3, 4, 5, 5));
}

// Before its minimum is over, Enter ends no break.
TEST_F(ParticipantSessionTest, TheExperimenterMayStop) {
    struct Case {
        std::deque<std::string> lines;
        std::vector<const char*> said;
        std::vector<std::uint32_t> done{1};
    };
    settings_.break_minimum = std::chrono::hours{1};
    for (const Case& c : {Case{{"", "", "q"}, {"continues for 3600 s"}},
                          Case{{"", "nonsense", "r"},
                               {"'nonsense' is not a command", "a reason is missing", "no more answers"}},
                          Case{{"q"}, {"next: trial 1"}, {}}}) {
        std::filesystem::remove(dataset_.records(2));
        trials_.prepared = 0;
        WrittenLines lines(c.lines);
        EXPECT_EQ(run_to_end(&lines).code, ExitCode::kRunFailed);
        EXPECT_EQ(positions(), c.done);
        EXPECT_EQ(trials_.prepared, static_cast<int>(1 + c.done.size())) << "before anybody is asked";
        for (const char* words : c.said) EXPECT_THAT(said_, Contains(HasSubstr(words)));
    }
}

TEST_F(ParticipantSessionTest, WhereNobodyIsAskedAWatcherMayHaveTheLastTrialAgain) {
    rests_ = false;
    for (const std::size_t after : {3U, 5U}) {  // in the middle, and after what was the last one
        WishAfter request(trials_, after, "r sneezed");
        wishes_ = &request;
        settings_.repeat = RepeatWhen::kAtOnce;
        run_to_end();
    }
    EXPECT_THAT(positions(), ElementsAre(1, 2, 3, 3, 4, 5, 5));
}

TEST_F(ParticipantSessionTest, AWatcherMayStopOrPauseIt) {
    rests_ = false;
    WishAfter quit(trials_, 2, "q");
    wishes_ = &quit;
    EXPECT_EQ(run_to_end().code, ExitCode::kRunFailed);
    EXPECT_EQ(trials_.numbers.size(), 2U);

    WishAfter nothing(trials_, 0, "");
    wishes_ = &nothing;
    const SessionTime until = trials_.clock + seconds{100};
    paused_ = [&] { return trials_.clock < until; };
    EXPECT_EQ(run_to_end().code, ExitCode::kOk);
    EXPECT_GE(trials_.clock, until + 3 * seconds{10});  // no trial before
}

// With any other input nothing begins before the release, and the trial is repeated without counting as a failure.
TEST_F(ParticipantSessionTest, AfterAStopNothingBeginsUntilItIsReleased) {
    settings_.repeats_limit = 0;
    settings_.break_every = 0;
    trials_.outcomes = {EndReason::kEmergencyStop};
    WrittenLines lines({"", "", "go", "release", "", "", "", "", "", ""});
    const ParticipantSessionResult result = run_to_end(&lines);
    EXPECT_EQ(result.code, ExitCode::kOk) << result.problem;
    EXPECT_THAT(said_, Contains(HasSubstr("emergency stop (master): a key, or type 'release'")));
    EXPECT_THAT(said_, Contains("released"));
    EXPECT_EQ(result.records, 6U);
    const auto records = read_records(dataset_.records(2));
    EXPECT_EQ(records[0].row.reason, EndReason::kEmergencyStop);
    EXPECT_TRUE(std::any_of(records.begin(), records.end(), [](const DatasetRecord& record) {
        return record.repeat_of == 1 && record.repeat_reason == "emergency_stop";
    }));
}

// Of the trial that was stopped, and of no other.
TEST_F(ParticipantSessionTest, WhileAStopHoldsTheLastTrialIsRejectedOrExcluded) {
    settings_.break_every = 0;
    for (const bool rejected : {true, false}) {
        std::filesystem::remove(dataset_.records(2));
        std::filesystem::remove(dataset_.exclusions());
        said_.clear();
        trials_.seen = 0;
        trials_.outcomes = {EndReason::kCompleted, EndReason::kEmergencyStop};
        const std::string mark = rejected ? "r a cable" : "x felt unwell";
        WrittenLines lines({"", "", mark, "", "nonsense", "release", "", "", "", "", "", ""});
        const ParticipantSessionResult result = run_to_end(&lines);
        EXPECT_EQ(result.code, ExitCode::kOk) << result.problem;
        const auto marks = read_exclusions(dataset_.exclusions());
        ASSERT_EQ(marks.size(), 1U);
        EXPECT_EQ(marks[0].record, 2U);
        EXPECT_EQ(marks[0].kind, rejected ? ExclusionKind::kRejected : ExclusionKind::kExcluded);
        EXPECT_EQ(marks[0].reason, mark.substr(2));
        EXPECT_THAT(said_, Contains("release the stop before anything begins"));
        EXPECT_THAT(said_, Contains("'nonsense' is not a command"));
        EXPECT_EQ(result.records, rejected ? 6U : 5U) << "who excludes a trial wants it no more";
    }
}

// The same from the experimenter's view.
TEST_F(ParticipantSessionTest, WhileAStopHoldsAWatcherMayHaveTheTrialLeftOut) {
    rests_ = false;
    settings_.break_every = 0;
    trials_.outcomes = {EndReason::kEmergencyStop};
    WishAfter exclude(trials_, 1, "x requested in the experimenter's view");
    WishAfter release(trials_, 1, "release");
    TwoLineSources requests(exclude, release);
    wishes_ = &requests;
    EXPECT_EQ(run_to_end().code, ExitCode::kOk);
    ASSERT_EQ(read_exclusions(dataset_.exclusions()).size(), 1U);
    EXPECT_THAT(positions(), ElementsAre(1, 2, 3, 4, 5));
}

}  // namespace
}  // namespace thimble
