#include "session/records/trial_table.hpp"

#include <bit>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "common/error.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble {
namespace {

TrialRow sample_row() {
    TrialRow row = make_row(sine_record(0.1 / 3, 0.003, 4));
    row.conditions.study_seed = ~std::uint64_t{0};
    row.conditions.modality = Modality::kCCF;
    row.conditions.delay_s = 0.05;
    row.delay_achieved_s = 0.050217;
    return row;
}

std::string message_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kData);
        return error.what();
    }
    ADD_FAILURE() << "nothing was thrown";
    return "";
}

void write_text(const std::filesystem::path& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
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
    table.append(sample_row());
    ASSERT_EQ(read_trial_table(directory / "trials.csv").size(), 1U);
    const TrialRow row = read_trial_table(directory / "trials.csv").front();
    EXPECT_EQ(row.conditions.study_seed, ~std::uint64_t{0});
    EXPECT_EQ(row.conditions.modality, Modality::kCCF);
    EXPECT_EQ(row.reason, EndReason::kCompleted);
    EXPECT_TRUE(row.metrics.beeped);
    EXPECT_TRUE(std::isnan(row.metrics.peak_displacement_m));
}

RC_GTEST_PROP(TrialTable, RoundTripToTheBit, (std::vector<double> numbers, std::uint32_t count, bool flag)) {
    const TemporaryDirectory directory;
    numbers.resize(11, kNaN);
    TrialRow row;
    row.conditions.fixture_position_m = numbers[0];
    row.metrics.penetration_mean_m = numbers[1];
    row.metrics.penetration_max_m = numbers[2] / 3;
    row.metrics.completion_time_s = numbers[3] * 1e-300;
    row.metrics.oscillation_rms_m = numbers[4] * 1e200;
    row.metrics.oscillation_peak_to_peak_m = -numbers[5];
    row.metrics.oscillation_frequency_Hz = numbers[6];
    row.metrics.puncture_time_s = numbers[7];
    row.metrics.first_contact_time_s = numbers[8];
    row.delay_achieved_s = numbers[9];
    row.round_trip_s = numbers[10];
    row.metrics.contacts_lost = count;
    row.metrics.oscillates = flag;
    TrialTable(directory / "t.csv").append(row);
    const TrialRow back = read_trial_table(directory / "t.csv").at(0);
    RC_ASSERT(same_bits(back.conditions.fixture_position_m, row.conditions.fixture_position_m));
    RC_ASSERT(same_bits(back.metrics.penetration_mean_m, row.metrics.penetration_mean_m));
    RC_ASSERT(same_bits(back.metrics.penetration_max_m, row.metrics.penetration_max_m));
    RC_ASSERT(same_bits(back.metrics.completion_time_s, row.metrics.completion_time_s));
    RC_ASSERT(same_bits(back.metrics.oscillation_rms_m, row.metrics.oscillation_rms_m));
    RC_ASSERT(same_bits(back.metrics.oscillation_peak_to_peak_m, row.metrics.oscillation_peak_to_peak_m));
    RC_ASSERT(same_bits(back.metrics.oscillation_frequency_Hz, row.metrics.oscillation_frequency_Hz));
    RC_ASSERT(same_bits(back.metrics.puncture_time_s, row.metrics.puncture_time_s));
    RC_ASSERT(same_bits(back.metrics.first_contact_time_s, row.metrics.first_contact_time_s));
    RC_ASSERT(same_bits(back.delay_achieved_s, row.delay_achieved_s));
    RC_ASSERT(same_bits(back.round_trip_s, row.round_trip_s));
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
    try {
        const TrialTable again(path);
        FAIL() << "an existing table was opened for writing";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kUsage);
        EXPECT_NE(std::string(error.what()).find("trials.csv: already exists"), std::string::npos);
    }
    TrialTable(path, IfExists::kContinue).append(sample_row());
    EXPECT_EQ(read_trial_table(path).size(), 2U);
    TrialTable(path, IfExists::kReplace).append(sample_row());
    EXPECT_EQ(read_trial_table(path).size(), 1U);
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
        const std::string message = message_of([&] { read_trial_table(path); });
        EXPECT_NE(message.find(c.complaint), std::string::npos) << message;
    }
}

TEST(TrialTable, SaysWhichCompensatorActed) {
    const TemporaryDirectory directory;
    TrialRow row = sample_row();
    row.conditions.compensator = Compensator::kWave;
    TrialTable(directory / "trials.csv").append(row);
    EXPECT_EQ(read_trial_table(directory / "trials.csv").at(0).conditions.compensator, Compensator::kWave);
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
    EXPECT_NE(message_of([&] {
                  const TrialTable table(path, IfExists::kContinue);
              }).find("24 columns instead of 25"),
              std::string::npos);
}

TEST(TrialTable, CutOffForeignAndMissingFiles) {
    const TemporaryDirectory directory;
    const auto path = directory / "trials.csv";
    TrialTable(path).append(sample_row());
    const std::string whole = read_text(path);
    write_text(path, whole.substr(0, whole.size() - 2));  // still a number, but not the one that was written
    EXPECT_NE(message_of([&] { read_trial_table(path); }).find(":2: is cut off"), std::string::npos);
    EXPECT_NE(message_of([&] { const TrialTable table(path, IfExists::kContinue); }).find(":2:"),
              std::string::npos);
    write_text(path, "experiment,subject\n");
    EXPECT_NE(message_of([&] { read_trial_table(path); }).find(":1: has 2 columns"), std::string::npos);
    write_text(path, "session" + whole.substr(10));
    EXPECT_NE(message_of([&] { read_trial_table(path); }).find(":1: column 1 (experiment): 'session'"),
              std::string::npos);
    write_text(path, "");
    EXPECT_NE(message_of([&] { read_trial_table(path); }).find(":1:"), std::string::npos);
    std::filesystem::remove(path);
    EXPECT_NE(message_of([&] { read_trial_table(path); }).find("cannot be read"), std::string::npos);
}

}  // namespace
}  // namespace thimble
