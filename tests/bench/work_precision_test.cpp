// thimble-bench work-precision, small: every solver has its rows, with errors that no clock can change. And mistakes of codecs.
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "common/process/child.hpp"
#include "tests/read_text.hpp"
#include "tests/refusal.hpp"

namespace thimble::test {
namespace {

using Row = std::map<std::string, std::string>;  // by the column's name
using testing::HasSubstr;

std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts;
    std::istringstream stream(text);
    for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
    return parts;
}

std::vector<Row> read_rows(const std::filesystem::path& file) {
    const std::vector<std::string> lines = split(read_text(file), '\n');
    const std::vector<std::string> names = split(lines.at(0), ',');
    std::vector<Row> rows(lines.size() - 1);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const std::vector<std::string> fields = split(lines[i + 1], ',');
        for (std::size_t k = 0; k < fields.size(); ++k) rows[i][names.at(k)] = fields[k];
    }
    return rows;
}

ProgramResult run_bench(const std::vector<std::string>& arguments, const std::filesystem::path& folder) {
    return run_program((std::filesystem::path(THIMBLE_BIN_DIR) / "thimble-bench").string(), arguments, folder,
                       "build thimble-bench");
}

class WorkPrecision : public testing::Test {
  protected:
    ProgramResult bench(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), {"work-precision", "--quick"});
        return run_bench(arguments, folder_.path());
    }

    TemporaryDirectory folder_;
};

TEST_F(WorkPrecision, WritesTableCsvAndFigure) {
    const ProgramResult result = bench({"--problem", "underdamped", "wall", "--out", "a"});
    ASSERT_EQ(result.exit_code, 0) << result.output;
    EXPECT_THAT(read_text(folder_ / "a/work_precision.svg"), HasSubstr("</svg>"));
    EXPECT_THAT(result.output, HasSubstr("| `underdamped` | rings at 10 Hz, damping ratio 0.05 |"));

    std::set<std::string> solvers, problems, outcomes;
    for (const Row& row : read_rows(folder_ / "a/work_precision.csv")) {
        solvers.insert(row.at("solver"));
        problems.insert(row.at("problem"));
        outcomes.insert(row.at("outcome"));
        if (row.at("solver") == "exact") {
            EXPECT_EQ(row.at("outcome"), "ok");
            EXPECT_LT(std::stod(row.at("position_error_m")), 1e-13);
            EXPECT_LT(std::stod(row.at("event_time_error_s")), 1e-12);
        }
        if (row.at("outcome") == "ok") {
            EXPECT_GT(std::stod(row.at("cost_least_ns_per_ms")), 0);
        }
    }
    EXPECT_EQ(problems, (std::set<std::string>{"underdamped", "wall"}));
    EXPECT_EQ(solvers.size(), 9U);
    EXPECT_EQ(solvers.count("boost_odeint"), 1U);
    EXPECT_EQ(solvers.count("cvode_bdf"), 1U);
    EXPECT_EQ(outcomes.count("unstable"), 1U);  // 1e6 N/m at 1 kHz
}

TEST_F(WorkPrecision, SaysHowToUseIt) {
    EXPECT_THAT(bench({"--help"}).output, HasSubstr("Example:"));
    const ProgramResult unknown = bench({"--problem", "soup"});
    EXPECT_EQ(unknown.exit_code, 2);
    EXPECT_THAT(unknown.output, HasSubstr("insert_100mm_s"));
    write_text(folder_ / "file", "in the way");
    const ProgramResult blocked = bench({"--problem", "press", "--out", "file/folder"});
    EXPECT_NE(blocked.exit_code, 0);
    EXPECT_THAT(blocked.output, HasSubstr("file: is a file"));
}

TEST(CodecStudy, RefusesAMistypedModalityNoTrialsAndADelayThatIsNone) {
    const TemporaryDirectory folder;
    for (const char* words :
         {"--modality=CFF", "--trials=0", "--subjects=0", "--delays-s=-1", "--delays-s=50"})
        EXPECT_EQ(run_bench({"codecs", words}, folder.path()).exit_code, 2) << words;
    const ProgramResult milliseconds = run_bench(
        {"codecs", "--subjects=1", "--trials=1", "--modality=CF", "--delays-s", "50ms"}, folder.path());
    EXPECT_EQ(milliseconds.exit_code, 0) << milliseconds.output;
    EXPECT_THAT(milliseconds.output, HasSubstr("| codec | 50 ms |"));
}

}  // namespace
}  // namespace thimble::test
