// The same seed gives the same bytes: again, on any number of threads, with more subjects, from any compiler.
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "session/virtual/virtual_session.hpp"
#include "study/study.hpp"
#include "tests/scenario/rig.hpp"
#include "tests/scenario/same_records.hpp"
#include "tests/scenario/trials.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble::test {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

// Every file of figures/ with its bytes; the pictures too, if gnuplot drew them.
std::map<std::string, std::string> figures_of(const std::filesystem::path& study) {
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(study / "figures"))
        files[entry.path().filename().string()] = read_text(entry.path());
    EXPECT_FALSE(files.empty()) << study;
    return files;
}

class Determinism : public testing::Test {
  protected:
    static StudyOptions small_study() {
        StudyOptions options;
        options.protocols = {experiment_3(paper(), 2, 1)};
        options.protocols[0].trials_per_modality = 1;
        options.jobs = 1;
        options.control = false;
        return options;
    }
    // The bytes of trials.csv.
    std::string study(StudyOptions options) {
        options.out = folder_ / std::to_string(studies_++);
        const StudyResult result = run_study(paper(), options);
        EXPECT_TRUE(result.complete);
        return read_text(options.out / "trials.csv");
    }

    TemporaryDirectory folder_;
    int studies_ = 0;
};

TEST_F(Determinism, TheSameSeedGivesTheSameBytesOnAnyNumberOfThreads) {
    StudyOptions options = small_study();
    const std::string first = study(options);
    const auto rows = read_trial_table(folder_ / "0" / "trials.csv");
    const auto trials = all_trials(options.protocols);
    ASSERT_EQ(rows.size(), 2U * 4);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_EQ(rows[i].conditions.subject, trials[i].subject);
        EXPECT_EQ(rows[i].conditions.trial, trials[i].trial);
    }
    for (const unsigned jobs : {2U, 3U}) {
        options.jobs = jobs;
        EXPECT_EQ(study(options), first) << jobs << " threads";
        const auto other = folder_ / std::to_string(studies_ - 1);
        EXPECT_EQ(whole_text(other / "findings.json"), read_text(folder_ / "0" / "findings.json"))
            << jobs << " threads";
        EXPECT_EQ(figures_of(other), figures_of(folder_ / "0")) << jobs << " threads";
    }
}

TEST_F(Determinism, MoreSubjectsAndControlTrialsChangeNoRowAndAnotherSeedChangesEach) {
    StudyOptions options = small_study();
    const std::string two = study(options);
    options.control = true;
    EXPECT_EQ(study(options), two);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "1" / "control.csv"));

    options.control = false;
    options.protocols[0].subjects = 3;
    const std::string three = study(options);
    EXPECT_EQ(three.substr(0, two.size()), two);
    EXPECT_EQ(lines_of(three).size(), 1U + 3 * 4);

    options.protocols[0].subjects = 2;
    options.protocols[0].seed = 2;
    const std::vector<std::string> one = lines_of(two), other = lines_of(study(options));
    ASSERT_EQ(one.size(), other.size());
    EXPECT_EQ(one[0], other[0]);
    for (std::size_t i = 1; i < one.size(); ++i) EXPECT_NE(one[i], other[i]);
}

TEST_F(Determinism, AResumedStudyIsTheUninterruptedOne) {
    StudyOptions options = small_study();
    options.protocols = {experiment_1(paper(), 2, 1), experiment_2(paper(), 2, 1),
                         experiment_3(paper(), 1, 1)};
    for (Protocol& protocol : options.protocols) protocol.trials_per_modality = 1;
    const std::string whole = study(options);

    options.out = folder_ / "interrupted";
    std::filesystem::create_directories(options.out);
    std::filesystem::copy(folder_ / "0" / "trials.txt", options.out);
    std::ofstream(options.out / "trials.csv", std::ios::binary) << whole.substr(0, whole.size() / 2);
    const std::string curves = read_text(folder_ / "0" / "trials_curves.csv");
    std::ofstream(options.out / "trials_curves.csv", std::ios::binary)
        << curves.substr(0, curves.size() / 3 * 2);
    options.if_exists = IfExists::kContinue;
    options.jobs = 2;
    const StudyResult result = run_study(paper(), options);
    EXPECT_TRUE(result.complete);
    EXPECT_GT(result.resumed, 0U);
    EXPECT_LT(result.resumed, result.rows.size());
    for (const char* file : {"trials.csv", "trials_curves.csv", "subjects.csv", "claims.json",
                             "findings.json", "summary.json", "report.html"}) {
        EXPECT_EQ(whole_text(options.out / file), read_text(folder_ / "0" / file)) << file;
    }
    EXPECT_EQ(figures_of(options.out), figures_of(folder_ / "0"));
}

TEST(DeterminismOfTrials, ATrialDoesNotDependOnTheOneBefore) {
    const TrialConditions first = trial_of(Modality::kHF, {}, 1, 1),
                          second = trial_of(Modality::kVF, {}, 1, 2);
    VirtualSession session(paper());
    session.run(first);
    const TrialRecord after = session.run(second);
    EXPECT_EQ(after.reason, EndReason::kCompleted);
    const TrialRecord alone = run_virtual_trial(paper(), second);
    EXPECT_TRUE(same_samples(after, alone)) << common_samples(after, alone) << " of " << alone.samples.size();
}

// Rows of trials.csv of the first trials of experiment 3, seed 1, subject 1, and behind each the hash of its
// trajectory: committed as text, so that every compiler and build type is held to the same bits.
class Golden : public Determinism {
  protected:
    static constexpr std::size_t kTrials = 8;

    std::string rows() {
        TrialTable table(folder_ / "trials.csv");
        std::vector<std::uint64_t> hashes;
        const auto trials = subject_trials(experiment_3(paper(), 1, 1), 1);
        for (std::size_t i = 0; i < kTrials; ++i) {
            const TrialRecord record = run_virtual_trial(paper(), trials[i]);
            table.append(make_row(record));
            hashes.push_back(TrajectoryHash(record).value());
        }
        const auto lines = lines_of(read_text(folder_ / "trials.csv"));
        std::string text = lines[0] + ",trajectory_fnv1a\n";
        for (std::size_t i = 0; i < kTrials; ++i)
            text += fmt::format("{},{:016x}\n", lines[i + 1], hashes[i]);
        return text;
    }
};

TEST_F(Golden, FirstTrialsOfSeedOne) {
    const std::filesystem::path golden =
        std::filesystem::path(THIMBLE_SOURCE_DIR) / "tests/scenario/experiment3_seed1_subject1.csv";
    const std::string text = rows();
    if (text == read_text(golden)) return;
    const std::filesystem::path given = std::filesystem::path(testing::TempDir()) / golden.filename();
    std::ofstream(given, std::ios::binary) << text;
    const auto expected_lines = lines_of(read_text(golden)), given_lines = lines_of(text);
    for (std::size_t i = 0; i < given_lines.size() && i < expected_lines.size(); ++i)
        EXPECT_EQ(given_lines[i], expected_lines[i]);
    ADD_FAILURE() << "the bits have changed. If the model was meant to: cp " << given.string() << ' '
                  << golden.string();
}

// Between its programs virtual time hands messages over. Behind a tap everything goes as bytes, as between real programs.
class MessagesAndBytes : public testing::TestWithParam<Modality> {
  protected:
    static FlowCounters counted(VirtualSession& session) {
        FlowCounters sum;
        for (const Role role : kNodeRoles) sum.add(session.node(role).counters());
        return sum;
    }

    static void expect_same(const SystemSettings& settings, Duration delay) {
        const TrialConditions conditions = trial_of(GetParam(), delay);
        VirtualSession handed_over(settings);
        VirtualSession as_bytes(settings, nullptr, {},
                                [](Port, Channel& end) { return std::make_unique<Tap>(end); });
        const TrialRecord &one = handed_over.run(conditions), &other = as_bytes.run(conditions);
        EXPECT_TRUE(same_samples(one, other)) << common_samples(one, other) << " of " << other.samples.size();
        EXPECT_EQ(one.reason, other.reason);
        EXPECT_EQ(one.round_trip_s, other.round_trip_s);
        EXPECT_EQ(one.beep_time_s, other.beep_time_s);
        EXPECT_GT(one.samples.size(), 1000U);
        EXPECT_EQ(counted(handed_over).accepted, counted(as_bytes).accepted);
        EXPECT_EQ(counted(handed_over).refused, counted(as_bytes).refused);
        EXPECT_EQ(handed_over.loop().ticks(), as_bytes.loop().ticks());
        for (std::size_t i = 0; i < handed_over.netem().relays().size(); ++i) {
            EXPECT_EQ(handed_over.netem().relays()[i].model.counters().delivered,
                      as_bytes.netem().relays()[i].model.counters().delivered);
        }
    }
};

TEST_P(MessagesAndBytes, HaveTheSameBitsWithAndWithoutDelay) {
    expect_same(paper(), {});
    expect_same(paper_with_delays({}, kPaperDelay), kPaperDelay);
}

// A link of a limited rate needs the length, a corrupting one the bytes, one that changes has packets of both kinds in flight.
TEST_P(MessagesAndBytes, HaveTheSameBitsOverABadNetwork) {
    SystemSettings settings = paper_with_delays({}, std::chrono::milliseconds{20});
    LinkSettings changed = settings.netem.force;
    changed.corrupt = 0.01;
    changed.duplicate = 0.01;
    changed.rate.bits_per_s = 2e6;
    LinkSettings later = settings.netem.force;
    later.delay = std::chrono::milliseconds{5};
    settings.netem.force_timeline = {{std::chrono::seconds{2}, changed}, {std::chrono::seconds{4}, later}};
    expect_same(settings, std::chrono::milliseconds{20});
    settings.netem.needle.jitter = {JitterShape::kUniform, std::chrono::milliseconds{3}, 0};
    expect_same(settings, std::chrono::milliseconds{20});
}

INSTANTIATE_TEST_SUITE_P(InEachModality, MessagesAndBytes, testing::ValuesIn(kModalities),
                         [](const auto& test) { return std::string(to_string(test.param)); });

TEST(ProtectedSession, HasTheSameBitsAsAnOpenOne) {
    for (const Modality modality : {Modality::kHF, Modality::kCCF}) {
        TrialConditions conditions;
        conditions.modality = modality;
        conditions.fixture_position_m = 0.035;
        const SystemSettings settings = paper_with_delays({}, kPaperDelay);
        VirtualSession open(settings), secured(settings, lab_key_of(42));
        const TrialRecord& plain = open.run(conditions);
        EXPECT_TRUE(same_samples(secured.run(conditions), plain));
        EXPECT_EQ(plain.reason, EndReason::kCompleted);
        const SecurityCounters counters = secured.network().counters();
        EXPECT_GT(counters.opened, 5000U);
        EXPECT_EQ(counters.handshakes, 10U);  // five, as both sides count them
        EXPECT_EQ(counters.forged + counters.replayed + counters.wrong_role + counters.unsealed +
                      counters.handshake_refused,
                  0U);
        EXPECT_EQ(open.network().counters().opened, 0U);
    }
}

}  // namespace
}  // namespace thimble::test
