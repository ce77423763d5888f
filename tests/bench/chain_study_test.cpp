// thimble-bench chain, small: real programs and bare processes take turns, and nothing is left running or lying about.
// What it measures is not judged here: only that it is a measurement.
#include <algorithm>
#include <sys/wait.h>

#include <nlohmann/json.hpp>

#include "bench/network/bare_chain.hpp"
#include "tests/bench/study_run.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble::test {
namespace {

class ChainStudy : public StudyRun {
  protected:
    ProgramResult chain(std::vector<std::string> more) const {
        const PortBlock ports;
        std::vector<std::string> arguments{"--rounds",     "2",           "--window-s",
                                           "0.3",          "--base-port", std::to_string(ports.base()),
                                           "--scheduling", "default",     "--json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return study("chain", arguments);
    }
};

// After what is said on stderr.
std::string json_of(const std::string& output) {
    const auto from = output.find("[\n");
    return from == std::string::npos ? "" : output.substr(from);
}

TEST_F(ChainStudy, MeasuresTheChainBesideBareProcesses) {
    const ProgramResult result = chain({});
    ASSERT_EQ(result.exit_code, 0) << result.output;
    const auto found = nlohmann::json::parse(json_of(result.output), nullptr, false);
    ASSERT_TRUE(found.is_array()) << result.output;
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0]["scheduling"], "default");
    ASSERT_EQ(found[0]["rows"].size(), 4U);
    for (const auto& row : found[0]["rows"]) {
        // Two system calls per hop take longer than this, and no window is longer than that.
        EXPECT_GT(row["bare_us"].get<double>(), 1) << row;
        EXPECT_GT(row["chain_us"].get<double>(), 1) << row;
        EXPECT_LT(row["chain_us"].get<double>(), 1e6) << row;
    }
    for (const char* node : {"master", "netem", "slave_sim"})
        EXPECT_GT(found[0]["turns_us"][node].get<double>(), 0) << node;
}

TEST_F(ChainStudy, SaysWhichProgramIsMissing) {
    const ProgramResult result = chain({"--programs", (folder_ / "nothing").string()});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.output.find("nothing/thimble-"), std::string::npos) << result.output;
}

TEST_F(ChainStudy, RefusesWhatItDoesNotKnow) {
    EXPECT_EQ(study("chain", {"--scheduling", "magic"}).exit_code, 2);
    EXPECT_EQ(study("chain", {"--rounds", "1"}).exit_code, 2);
    EXPECT_NE(study("chain", {"--help"}).output.find("Example:"), std::string::npos);
}

TEST(BareChainProcesses, AnswerAndAreGoneAfterwards) {
    RuntimeSettings ordinary;
    ordinary.realtime_scheduling = false;
    const std::vector<double> took_us = bare_chain_round_trips(ordinary, std::chrono::milliseconds{300});
    EXPECT_GT(took_us.size(), 30U);  // of 300; the machine may stall
    EXPECT_LE(took_us.size(), 301U);
    EXPECT_GT(*std::min_element(took_us.begin(), took_us.end()), 1);
    EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);  // no child is left
}

}  // namespace
}  // namespace thimble::test
