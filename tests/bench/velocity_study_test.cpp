// thimble-bench velocity, small: it runs, it gives the same bytes again, and its ruler is straight: where the
// answer is known on paper, it measures that.
#include "tests/bench/study_run.hpp"

namespace thimble::test {
namespace {

class VelocityStudy : public StudyRun {
  protected:
    ProgramResult bench(const std::vector<std::string>& arguments) const {
        return study("velocity", arguments);
    }
    // By "method setting".
    std::map<std::string, Row> rows(const std::string& file) const {
        std::map<std::string, Row> found;
        for (const Row& row : table(file)) found[row.at("method") + ' ' + row.at("setting")] = row;
        return found;
    }
};

TEST_F(VelocityStudy, MeasuresWhatIsKnownOnPaperTheSameEachTime) {
    const ProgramResult result = bench({"--quick", "--out", "a"});
    ASSERT_EQ(result.exit_code, 0) << result.output;
    ASSERT_EQ(bench({"--quick", "--out", "b"}).exit_code, 0);
    EXPECT_EQ(text("a/velocity.csv"), text("b/velocity.csv"));
    EXPECT_NE(text("a/velocity.svg").find("</svg>"), std::string::npos);
    const auto found = rows("a/velocity.csv");
    ASSERT_GE(found.size(), 15U);

    const Row& ideal = found.at("ideal ");
    EXPECT_LT(number(ideal, "noise_rms_m_per_s"), 1e-7);
    EXPECT_NEAR(number(ideal, "lag_s"), 0.0005, 1e-5);  // a difference looks half a step back
    EXPECT_EQ(number(ideal, "false_punctures"), 0);
    EXPECT_LT(number(ideal, "contact_force_noise_N"), 1e-6);

    // A moving average over W, differenced, is W / 2 late at every frequency.
    const Row& windowed = found.at("windowed 20 ms");
    EXPECT_NEAR(number(windowed, "lag_s"), 0.010, 2e-4);
    EXPECT_NEAR(number(windowed, "tremor_phase_lag_rad"), 0.628, 0.02);
    EXPECT_NEAR(number(windowed, "tremor_gain"), 0.935, 0.02);  // sin(w W / 2) / (w W / 2)
    EXPECT_LE(number(windowed, "noise_peak_m_per_s"), 1.0001 * 3e-5 / 0.020);

    const Row& raw = found.at("raw ");
    EXPECT_EQ(number(raw, "false_punctures"), number(raw, "presses"));
    EXPECT_LE(number(raw, "noise_peak_m_per_s"), 1.0001 * 3e-5 / 0.001);
    EXPECT_TRUE(raw.at("contact_force_noise_N").empty());  // no press lasts
    for (const auto& [name, row] : found) {
        EXPECT_LE(number(row, "noise_rms_m_per_s"), number(raw, "noise_rms_m_per_s")) << name;
    }
}

TEST_F(VelocityStudy, AnotherSeedGivesOtherBytes) {
    ASSERT_EQ(bench({"--quick", "--out", "a", "--seed", "7"}).exit_code, 0);
    ASSERT_EQ(bench({"--quick", "--out", "b", "--seed", "8"}).exit_code, 0);
    EXPECT_NE(text("a/velocity.csv"), text("b/velocity.csv"));
}

TEST_F(VelocityStudy, SaysHowToUseIt) {
    const ProgramResult help = bench({"--help"});
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_NE(help.output.find("Example:"), std::string::npos) << help.output;
    EXPECT_EQ(bench({"--jitter", "1"}).exit_code, 2);
    EXPECT_EQ(bench({"--nonsense"}).exit_code, 2);
}

TEST_F(VelocityStudy, AFolderThatCannotBeWrittenIsAnError) {
    std::ofstream(folder_ / "file") << "in the way";
    const ProgramResult result = bench({"--quick", "--out", "file/folder"});
    EXPECT_NE(result.exit_code, 0);
    EXPECT_NE(result.output.find("file/folder"), std::string::npos) << result.output;
}

}  // namespace
}  // namespace thimble::test
