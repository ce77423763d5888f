// thimble-bench work-precision, small: every solver has its rows, with errors that no clock can change.
#include <set>

#include "tests/bench/study_run.hpp"

namespace thimble::test {
namespace {

class WorkPrecision : public StudyRun {
  protected:
    ProgramResult bench(const std::vector<std::string>& arguments) const {
        return study("work-precision", arguments);
    }
};

TEST_F(WorkPrecision, WritesTableCsvAndFigure) {
    const ProgramResult result = bench({"--quick", "--out", "a"});
    ASSERT_EQ(result.exit_code, 0) << result.output;
    EXPECT_NE(text("a/work_precision.svg").find("</svg>"), std::string::npos);
    EXPECT_NE(result.output.find("exact: position error below 1e-13 m"), std::string::npos) << result.output;

    std::set<std::string> solvers;
    for (const Row& row : table("a/work_precision.csv")) {
        solvers.insert(row.at("solver"));
        if (row.at("solver") == "exact") {
            EXPECT_EQ(row.at("outcome"), "ok");
            EXPECT_LT(number(row, "position_error_m"), 1e-13);
            EXPECT_LT(number(row, "event_time_error_s"), 1e-12);
        }
        if (row.at("outcome") == "ok") {
            EXPECT_GT(number(row, "cost_least_ns_per_ms"), 0);
        }
    }
    EXPECT_EQ(solvers.size(), 9U);
    EXPECT_EQ(solvers.count("boost_odeint"), 1U);
    EXPECT_EQ(solvers.count("cvode_bdf"), 1U);

    std::set<std::string> outcomes;
    for (const Row& row : table("a/real_time.csv")) outcomes.insert(row.at("outcome"));
    EXPECT_EQ(outcomes, (std::set<std::string>{"ok", "unstable"}));  // 1e6 N/m at 1 kHz
}

TEST_F(WorkPrecision, TakesTheProblemsThatAreNamed) {
    ASSERT_EQ(bench({"--quick", "--problem", "press", "wall", "--out", "a"}).exit_code, 0);
    std::set<std::string> found;
    for (const Row& row : table("a/work_precision.csv")) found.insert(row.at("problem"));
    EXPECT_EQ(found, (std::set<std::string>{"press", "wall"}));
}

TEST_F(WorkPrecision, SaysHowToUseIt) {
    EXPECT_NE(bench({"--help"}).output.find("Example:"), std::string::npos);
    const ProgramResult unknown = bench({"--problem", "soup"});
    EXPECT_EQ(unknown.exit_code, 2);
    EXPECT_NE(unknown.output.find("insert_100mm_s"), std::string::npos) << unknown.output;
    std::ofstream(folder_ / "file") << "in the way";
    const ProgramResult blocked = bench({"--quick", "--problem", "press", "--out", "file/folder"});
    EXPECT_NE(blocked.exit_code, 0);
    EXPECT_NE(blocked.output.find("file/folder"), std::string::npos) << blocked.output;
}

}  // namespace
}  // namespace thimble::test
