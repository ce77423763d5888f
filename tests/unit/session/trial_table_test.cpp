#include "session/records/trial_table.hpp"

#include <array>
#include <bit>
#include <cerrno>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "common/text_file.hpp"
#include "session/records/condition_summary.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

TrialRow sample_row() {
    TrialRow row = make_row(sine_record(0.1 / 3, 0.003, 4));
    row.conditions.study_seed = ~std::uint64_t{0};
    row.conditions.modality = Modality::kCCF;
    row.conditions.delay_s = 0.05;
    row.delay_achieved_s = 0.050217;
    return row;
}

// A good table of one row, whose n-th field from 0 has been replaced.
std::string damaged(const std::filesystem::path& path, std::size_t field, const std::string& text) {
    TrialTable(path, IfExists::kReplace).append(sample_row());
    const std::string whole = read_text(path);
    std::size_t begin = whole.find('\n') + 1;
    for (std::size_t i = 0; i < field; ++i) begin = whole.find(',', begin) + 1;
    const std::size_t end = whole.find_first_of(",\n", begin);
    return whole.substr(0, begin) + text + whole.substr(end);
}

bool same_bits(double a, double b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) ||
           (std::isnan(a) && std::isnan(b));
}

TEST(TrialTable, HeaderNamesEveryColumnInSI) {
    const TemporaryDirectory directory;
    const TrialTable table(directory / "trials.csv");
    EXPECT_EQ(
        read_text(directory / "trials.csv"),
        "experiment,subject,trial,modality,delay_s,fixture_position_m,penetration_mean_m,penetration_max_m,"
        "completion_time_s,peak_displacement_m,contacts_lost,oscillation_rms_m,oscillation_peak_to_peak_m,"
        "oscillation_frequency_Hz,oscillates,beeped,outcome,seed,fixture_removed,delay_achieved_s,round_trip_"
        "s,"
        "puncture_time_s,first_contact_time_s,duration_s,remedy\n");
}

TEST(TrialTable, RowIsInTheFileWhenAppendReturns) {
    const TemporaryDirectory directory;
    TrialTable table(directory / "trials.csv");
    TrialRow written = sample_row();
    written.conditions.compensator = Compensator::kWave;
    table.append(written);
    ASSERT_EQ(read_trial_table(directory / "trials.csv").size(), 1U);
    const TrialRow row = read_trial_table(directory / "trials.csv").front();
    EXPECT_EQ(row.conditions.study_seed, ~std::uint64_t{0});
    EXPECT_EQ(row.conditions.modality, Modality::kCCF);
    EXPECT_EQ(row.reason, EndReason::kCompleted);
    EXPECT_EQ(row.conditions.compensator, Compensator::kWave);
    EXPECT_TRUE(row.metrics.beeped);
    EXPECT_TRUE(std::isnan(row.metrics.peak_displacement_m));
}

// The numbers of a row that a trial may lack.
std::array<double*, 11> numbers_of(TrialRow& row) {
    TrialMetrics& m = row.metrics;
    return {&row.conditions.fixture_position_m,
            &m.penetration_mean_m,
            &m.penetration_max_m,
            &m.completion_time_s,
            &m.oscillation_rms_m,
            &m.oscillation_peak_to_peak_m,
            &m.oscillation_frequency_Hz,
            &m.puncture_time_s,
            &m.first_contact_time_s,
            &row.delay_achieved_s,
            &row.round_trip_s};
}

RC_GTEST_PROP(TrialTable, RoundTripToTheBit, (std::vector<double> numbers, std::uint32_t count, bool flag)) {
    constexpr std::array kScales{1.0, 1.0, 1.0 / 3, 1e-300, 1e200, -1.0};
    const TemporaryDirectory directory;
    numbers.resize(11, kNaN);
    TrialRow row;
    for (std::size_t i = 0; i < numbers.size(); ++i)
        *numbers_of(row)[i] = numbers[i] * kScales[i % kScales.size()];
    row.metrics.contacts_lost = count;
    row.metrics.oscillates = flag;
    TrialTable(directory / "t.csv").append(row);
    TrialRow back = read_trial_table(directory / "t.csv").at(0);
    for (std::size_t i = 0; i < numbers.size(); ++i)
        RC_ASSERT(same_bits(*numbers_of(back)[i], *numbers_of(row)[i]));
    RC_ASSERT(back.metrics.contacts_lost == count);
    RC_ASSERT(back.metrics.oscillates == flag);
}

TEST(TrialTable, EveryOutcomeReadsBack) {
    for (const EndReason reason : {EndReason::kNone, EndReason::kCompleted, EndReason::kTimeout,
                                   EndReason::kPeerLost, EndReason::kInterrupted, EndReason::kDeviceFault,
                                   EndReason::kSafetyStop, EndReason::kEmergencyStop}) {
        for (const Role role :
             {Role::kMaster, Role::kSlaveSim, Role::kCutaneous, Role::kVisual, Role::kNetem}) {
            EndReason reason_back = EndReason::kNone;
            Role role_back = Role::kSession;
            ASSERT_TRUE(parse_outcome(outcome_text(reason, role), reason_back, role_back));
            EXPECT_EQ(reason_back, reason);
            if (reason == EndReason::kPeerLost || reason == EndReason::kDeviceFault ||
                reason == EndReason::kSafetyStop) {
                EXPECT_EQ(role_back, role);
            }
        }
    }
    EXPECT_EQ(outcome_text(EndReason::kPeerLost, Role::kSlaveSim), "peer_lost_slave_sim");
    EndReason reason{};
    Role role{};
    EXPECT_FALSE(parse_outcome("peer_lost_", reason, role));
    EXPECT_FALSE(parse_outcome("", reason, role));
}

TEST(TrialTable, RefusesReplacesContinues) {
    const TemporaryDirectory directory;
    const auto path = directory / "trials.csv";
    TrialTable(path).append(sample_row());
    EXPECT_THAT(refusal([&] { const TrialTable again(path); }, ExitCode::kUsage),
                HasSubstr("trials.csv: already exists"));
    TrialTable(path, IfExists::kContinue).append(sample_row());
    EXPECT_EQ(read_trial_table(path).size(), 2U);
    TrialTable(path, IfExists::kReplace).append(sample_row());
    EXPECT_EQ(read_trial_table(path).size(), 1U);
}

// A start that failed leaves one, and does not keep the next start from the folder.
TEST(TrialTable, ATableWithoutATrialIsAsGoodAsNone) {
    const TemporaryDirectory directory;
    const auto path = directory / "trials.csv";
    {
        const TrialTable first(path);
        EXPECT_THAT(refusal([&] { const TrialTable other(path); }, ExitCode::kUsage),
                    HasSubstr("already exists"))
            << "it is being written";
    }
    const std::string header = read_text(path);
    write_text(path, header.substr(0, 20));  // a crash
    TrialTable(path).append(sample_row());
    EXPECT_EQ(read_trial_table(path).size(), 1U);
    write_text(path, "another table\n");
    EXPECT_THAT(refusal([&] { const TrialTable other(path); }, ExitCode::kUsage),
                HasSubstr("already exists"));
}

TEST(TrialTable, TwoProgramsDoNotWriteOne) {
    const TemporaryDirectory directory;
    const auto path = directory / "trials.csv";
    TrialTable first(path);
    first.append(sample_row());
    for (const IfExists if_exists : {IfExists::kReplace, IfExists::kContinue}) {
        EXPECT_THAT(refusal([&] { const TrialTable other(path, if_exists); }, ExitCode::kUsage),
                    HasSubstr("another program is writing this file"));
    }
    EXPECT_EQ(read_trial_table(path).size(), 1U) << "and nothing was emptied";
}

TEST(TrialTable, ADeletedTableIsNoticedAtTheNextRow) {
    const TemporaryDirectory directory;
    TrialTable table(directory / "trials.csv");
    std::filesystem::remove(directory / "trials.csv");
    EXPECT_THAT(refusal([&] { table.append(sample_row()); }, ExitCode::kRunFailed),
                HasSubstr("trials.csv: was deleted during the run"));
}

TEST(TrialTable, NothingIsWrittenThroughASymbolicLink) {
    const TemporaryDirectory directory;
    const auto precious = directory / "precious", link = directory / "trials.csv";
    write_text(precious, "kept");
    std::filesystem::create_symlink(precious, link);
    for (const IfExists if_exists : {IfExists::kReplace, IfExists::kContinue}) {
        EXPECT_THAT(refusal([&] { const TrialTable table(link, if_exists); }, ExitCode::kUsage),
                    HasSubstr("trials.csv: is a symbolic link"));
    }
    EXPECT_THAT(refusal([&] { write_text_file(link, "lost"); }, ExitCode::kUsage), HasSubstr("remove it"));
    EXPECT_EQ(read_text(precious), "kept");
    write_text_file("/dev/stderr", "");  // a link of the system
}

TEST(TrialTable, AFileThatCannotBeMadeIsNamedWithARemedy) {
    const auto words = [](int error, ExitCode code) {
        return refusal([&] { fail_to_create("out/trials.csv", error); }, code);
    };
    EXPECT_EQ(words(EROFS, ExitCode::kUsage),
              "out/trials.csv: cannot be created: Read-only file system; name a "
              "folder on a writable disk");
    EXPECT_THAT(words(EMFILE, ExitCode::kRunFailed), HasSubstr("raise 'ulimit -n'"));
    EXPECT_THAT(words(ENOSPC, ExitCode::kRunFailed), HasSubstr("free space on that disk"));
}

// A trial that was lost before its beep, or before it began.
TEST(TrialTable, ACourseHasNoNumberThatIsNotKnown) {
    TrialRow row;
    row.reason = EndReason::kPeerLost;
    row.lost_peer = Role::kNetem;
    EXPECT_EQ(course_text(row), "peer_lost_netem");
    row.metrics.duration_s = 2.04;
    EXPECT_EQ(course_text(row), "peer_lost_netem, ended after 2.0 s");
    row.reason = EndReason::kCompleted;
    row.metrics.completion_time_s = 1.5;
    row.metrics.penetration_max_m = 0.00123;
    EXPECT_EQ(course_text(row), "completed, 1.5 s, maximum penetration 1.23 mm");
}

TEST(TrialTable, DamageIsNamedWithLineAndColumn) {
    const TemporaryDirectory directory;
    const auto path = directory / "trials.csv";
    struct Case {
        std::size_t field;
        const char* text;
        const char* complaint;
    };
    for (const Case& c :
         {Case{4, "0.0.5", ":2: column 5 (delay_s): '0.0.5'"}, Case{6, "nan", ":2: column 7 (penet"},
          Case{6, "1e999", ":2: column 7 (penetration_mean_m)"}, Case{3, "HFC", "column 4 (modality)"},
          Case{1, "-1", ":2: column 2 (subject)"}, Case{2, "4294967296", ":2: column 3 (trial)"},
          Case{14, "true", ":2: column 15 (oscillates)"}, Case{16, "done", ":2: column 17 (outcome)"},
          Case{17, "18446744073709551616", ":2: column 18 (seed)"}, Case{0, "3,4", ":2: has 26 fields"},
          Case{24, "waves", ":2: column 25 (remedy)"}}) {
        write_text(path, damaged(path, c.field, c.text));
        EXPECT_THAT(refusal([&] { read_trial_table(path); }), HasSubstr(c.complaint));
    }
}

// It is read, and not gone on with: its lines are shorter.
TEST(TrialTable, ATableFromBeforeTheColumnOfCompensators) {
    const TemporaryDirectory directory;
    const auto path = directory / "trials.csv";
    TrialTable(path).append(sample_row());
    std::string text = read_text(path);
    for (const char* last : {",remedy", ",none"}) text.erase(text.find(last), std::string(last).size());
    write_text(path, text);
    const std::vector<TrialRow> rows = read_trial_table(path);
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(rows[0].conditions.compensator, Compensator::kNone);
    EXPECT_EQ(rows[0].conditions.study_seed, ~std::uint64_t{0});
    EXPECT_THAT(refusal([&] { const TrialTable table(path, IfExists::kContinue); }),
                HasSubstr("24 columns instead of 25"));
}

TEST(TrialTable, CutOffForeignAndMissingFiles) {
    const TemporaryDirectory directory;
    const auto path = directory / "trials.csv";
    TrialTable(path).append(sample_row());
    const std::string whole = read_text(path);
    // Still a number, but not the one that was written.
    const std::string cut = whole.substr(0, whole.size() - 2);
    for (const auto& [text, complaint] :
         {std::pair{cut, ":2: is cut off"},
          std::pair{std::string("experiment,subject\n"), ":1: has 2 columns"},
          std::pair{"session" + whole.substr(10), ":1: column 1 (experiment): 'session'"},
          std::pair{std::string(), ":1:"}}) {
        write_text(path, text);
        EXPECT_THAT(refusal([&] { read_trial_table(path); }), HasSubstr(complaint));
    }
    write_text(path, cut);
    EXPECT_THAT(refusal([&] { const TrialTable table(path, IfExists::kContinue); }), HasSubstr(":2:"));
    std::filesystem::remove(path);
    EXPECT_THAT(refusal([&] { read_trial_table(path); }), HasSubstr("cannot be read"));
}

}  // namespace
}  // namespace thimble
