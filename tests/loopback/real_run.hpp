// `thimble run` under test: a session file and ports of its own, everything it writes, and its nodes'
// processes.
#pragma once

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "session/records/trajectory_file.hpp"
#include "session/records/trial_table.hpp"
#include "tests/loopback/programs.hpp"

namespace thimble {

// More arguments of a run whose subject is not wall time: it waits for nothing, and its bytes are the same each time.
inline const std::vector<std::string> kLockStep{"--clock", "lock-step"};

class RealRun {
  public:
    explicit RealRun(const SessionFile& session, const std::vector<std::string>& more_arguments = {},
                     const std::filesystem::path& programs = built_programs());

    // Waits until a trial runs: its first samples are on the disk. False if the run ended before.
    bool reaches_trial();
    // Waits for one of its nodes; throws std::runtime_error if it does not appear.
    pid_t node(const std::string& program) const;
    // Waits until the file of the first trial has its last line, which is returned.
    std::string first_trial_end();
    // Waits for the end of the run: the exit code, -1 if it does not come.
    int end();

    Child& launcher() { return child_; }
    std::uint16_t base_port() const { return ports_.base(); }
    std::filesystem::path out() const { return folder_ / "out"; }
    std::string words() const { return read_text(folder_ / "words"); }
    std::vector<TrialRow> rows() const { return read_trial_table(out() / "trials.csv"); }
    // Its one trial, and how that ended; the test fails if there is not exactly one.
    TrialRow only_row() const;
    EndReason only_reason() const { return only_row().reason; }
    std::filesystem::path trajectory_path(const TrialConditions& trial) const;
    // The node's report; null if it wrote none.
    nlohmann::json report(const std::string& program, int delay_ms = 0) const;

    // As far as it is written; empty before.
    std::string first_trajectory() const;

  private:
    Folder folder_;
    PortBlock ports_;
    Child child_;
};

// Ends with this code and these words; its one trial ended so, and no node is left.
inline void expect_end(RealRun& run, int code, EndReason reason, const std::string& words = "") {
    EXPECT_EQ(run.end(), code) << run.words();
    EXPECT_THAT(run.words(), testing::HasSubstr(words));
    EXPECT_EQ(run.only_reason(), reason) << run.words();
    EXPECT_THAT(nodes_alive(run.base_port()), testing::IsEmpty());
}

// A node's report of a run in which it heard the others and nothing that it had to refuse.
inline void expect_report(const nlohmann::json& report, const std::string& program) {
    ASSERT_FALSE(report.is_null()) << program;
    EXPECT_EQ(report.at("program"), program);
    EXPECT_GT(report.at("accepted"), 0) << program;
    for (const char* harmful :
         {"malformed", "not_finite", "out_of_range", "second_sender", "unexpected_kind"}) {
        EXPECT_EQ(report.at("refused").at(harmful), 0) << program << ' ' << harmful;
    }
}

}  // namespace thimble
