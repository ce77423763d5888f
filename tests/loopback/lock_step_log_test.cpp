// The logs of messages of a run in lock-step: the same each time, a file for each program and trial.
#include <fstream>
#include <map>

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
    // Its results are those of virtual time.
    void run_well(const std::string& session, const std::vector<std::string>& more = {}) const {
        const std::string file = folder_.write("session.toml", session).string();
        const Outcome outcome =
            run_thimble(words_in(fmt::format("run {} --clock lock-step --out {} --base-port {}", file,
                                             out_.string(), ports_.base()),
                                 more));
        ASSERT_EQ(outcome.code, 0) << outcome.words;
        EXPECT_EQ(whole_text(out_ / "trials.csv"), read_text(out_ / "virtual.csv"));
    }
    fs::path log(const std::string& program, int trial) const {
        return out_ / "nodes" / fmt::format("{}_50ms_trial{:02}.mcap", program, trial);
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
    void expect_good_logs() const {
        std::vector<std::string> check{"log", "check"};
        for (const std::string& program : programs()) check.push_back(log(program, 1).string());
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

    const Folder folder_;
    const PortBlock ports_;
    const fs::path out_ = folder_ / "out";
};

TEST_F(LockStepLog, IsTheSameEachTimeAndChangesNoByteOfTheResults) {
    run_well(kLoggedSession);
    std::map<fs::path, std::string> first;
    for (const std::string& program : programs()) {
        for (const int trial : {1, 2}) first[log(program, trial)] = messages(log(program, trial));
    }
    for (const auto& [path, unused] : first) std::ofstream(path) << "to be replaced on request";
    run_well(kLoggedSession, {"--overwrite"});
    expect_good_logs();
    expect_only_messages_on_standard_output(log("session", 2));
    EXPECT_THAT(messages(log("session", 2)), HasSubstr("/slave_sim/record"));
    for (const auto& [path, all] : first) {
        EXPECT_GT(all.size(), 1000U) << path;
        EXPECT_TRUE(all == messages(path)) << path;
    }
}

// Five programs with haptic codecs: the bytes of virtual time, and no message that was not sent counts as lost.
TEST_F(LockStepLog, OfCodecsLacksNothingAndHasTheResultsOfVirtualTime) {
    run_well(std::string(kLoggedSession) + "[codec]\ncommand = 'deadband-linear'\nforce = 'deadband'\n");
    expect_good_logs();
}

}  // namespace
}  // namespace thimble
