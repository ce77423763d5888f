// The logs of messages of a run in lock-step: the same each time, a file for each program and trial.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "session/log/logged_file.hpp"
#include "tests/loopback/programs.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* kLoggedSession =
    "[session]\nmodalities = ['CF', 'VF']\ndelays_s = [0.05]\n[trial]\ncontact_hold_s = 0.3\n"
    "[netem.needle]\nloss = 0.01\n[log]\nmessages = 'all'\n";

class LockStepLog : public testing::Test {
  protected:
    Outcome run(const std::string& out, const std::string& clock, const std::vector<std::string>& more = {}) {
        const std::string file = folder_.write("session.toml", session_).string();
        return run_thimble(words_in(fmt::format("run {} --clock {} --out {} --base-port {}", file, clock,
                                                (folder_ / out).string(), ports_.base()),
                                    more));
    }
    fs::path log(const std::string& out, const std::string& program, int trial) const {
        return folder_ / out / "nodes" / fmt::format("{}_50ms_trial{:02}.mcap", program, trial);
    }
    // Topics, times and bytes.
    static std::string messages(const fs::path& path) {
        std::string all;
        const LoggedFile file(path);
        file.for_each([&all](const LoggedTopic& topic, const McapMessage& m) {
            all += fmt::format("{} {} {} {} ", topic.topic, topic.sent, m.log_time_ns, m.publish_time_ns);
            all.append(m.data.begin(), m.data.end());
        });
        return all;
    }
    std::vector<std::string> programs() const {
        std::vector<std::string> all{kNodePrograms.begin(), kNodePrograms.end()};
        all.emplace_back("session");
        return all;
    }
    // `thimble log check` of the first trial's.
    void expect_good_logs(const std::string& out) const {
        std::vector<std::string> check{"log", "check"};
        for (const std::string& program : programs()) check.push_back(log(out, program, 1).string());
        const Outcome outcome = run_thimble(check);
        EXPECT_EQ(outcome.code, 0) << outcome.words;
    }
    // The line for a table that is exported at the same time is on standard error.
    void expect_only_messages_on_standard_output(const fs::path& file) const {
        const std::string out = (folder_ / "export").string();
        const std::string json =
            run_to_end(
                "/bin/sh",
                {"-c", fmt::format("'{}' log export '{}' --csv '{}' --hdf5 '{}.h5' --ros2 '{}.mcap' "
                                   "--json - 2>/dev/null",
                                   (built_programs() / "thimble").string(), file.string(), out, out, out)})
                .words;
        EXPECT_THAT(json, testing::StartsWith("{"));
        EXPECT_THAT(json, testing::EndsWith("}\n"));
    }
    // `one` has the results of this session in virtual time.
    void expect_results_of_virtual_time() {
        ASSERT_EQ(run("virtual", "virtual").code, 0);
        EXPECT_EQ(whole_text(folder_ / "one/trials.csv"), read_text(folder_ / "virtual/trials.csv"));
    }

    const Folder folder_;
    const PortBlock ports_;
    std::string session_ = kLoggedSession;
};

TEST_F(LockStepLog, IsTheSameEachTimeAndChangesNoByteOfTheResults) {
    const auto run_well = [this](const char* out, const std::vector<std::string>& more = {}) {
        const Outcome outcome = run(out, "lock-step", more);
        ASSERT_EQ(outcome.code, 0) << outcome.words;
    };
    run_well("one");
    run_well("other");
    static_cast<void>(folder_.write("one/nodes/session_50ms_trial02.mcap", "to be replaced on request"));
    run_well("one", {"--overwrite"});
    expect_good_logs("one");
    expect_only_messages_on_standard_output(log("one", "session", 2));
    EXPECT_THAT(messages(log("one", "session", 2)), HasSubstr("/slave_sim/record"));
    for (const std::string& program : programs()) {
        for (const int trial : {1, 2}) {
            SCOPED_TRACE(fmt::format("{} {}", program, trial));
            const std::string one = messages(log("one", program, trial));
            EXPECT_GT(one.size(), 1000U);
            EXPECT_TRUE(one == messages(log("other", program, trial)));
        }
    }
    session_ = session_.substr(0, session_.find("[log]"));
    expect_results_of_virtual_time();
}

// Five programs with haptic codecs: the bytes of virtual time, and no message that was not sent counts as lost.
TEST_F(LockStepLog, OfCodecsLacksNothingAndHasTheResultsOfVirtualTime) {
    session_ += "[codec]\ncommand = 'deadband-linear'\nforce = 'deadband'\n";
    ASSERT_EQ(run("one", "lock-step").code, 0);
    expect_good_logs("one");
    session_.replace(session_.find("'all'"), 5, "'none'");
    expect_results_of_virtual_time();
}

}  // namespace
}  // namespace thimble
