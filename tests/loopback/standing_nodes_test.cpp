// Nodes that a laboratory has running all day, which `thimble run --attach` steers again and again: runs and participants'
// sessions, with a lab key and without, also after one of them was started anew.
#include <array>
#include <csignal>
#include <cstdint>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "session/records/trial_table.hpp"
#include "tests/loopback/programs.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {
namespace {

// Of the nodes, which take nothing of it from the run that steers them: without, each trial holds for 5 s.
constexpr const char* kShortContact = "[trial]\ncontact_hold_s = 0.2\n";

enum class Protection : std::uint8_t { kNone, kUserKey, kLabKey };

class StandingNodes : public testing::TestWithParam<Protection> {
  protected:
    StandingNodes() {
        if (GetParam() == Protection::kNone) protection_ = kUnprotectedTable;
        if (GetParam() == Protection::kLabKey) make_key();
        for (const char* program : kNodePrograms) start(program);
    }

    void start(const std::string& program) {
        nodes_.erase(program);
        const auto words = words_in(
            fmt::format("{} --base-port {} --die-with-parent",
                        folder_.write("node.toml", kShortContact + protection_).string(), ports_.base()));
        nodes_.try_emplace(program, built_programs() / program, words, folder_ / program);
    }
    void kill(const std::string& program) {
        nodes_.at(program).signal(SIGKILL);
        nodes_.at(program).wait(kPatience);
    }
    // thimble run with these nodes.
    Outcome attach(const std::string& out, const std::string& protocol = "", const std::string& more = "") {
        SessionFile session;
        session.contact_hold_s = 0.2;
        session.delays_s = "";
        session.more = protocol + protection_;
        const std::string file = folder_.write(out + ".toml", session.text()).string();
        return run_thimble(words_in(fmt::format("run {} --attach --out {} --base-port {} {}", file,
                                                (folder_ / out).string(), ports_.base(), more)));
    }
    void expect_a_trial(const std::string& out) {
        const Outcome run = attach(out);
        EXPECT_EQ(run.code, 0) << run.words;
        EXPECT_EQ(read_trial_table(folder_ / out / "trials.csv").size(), 1U);
    }

    Folder folder_;
    PortBlock ports_;

  private:
    void make_key() {
        const auto key = folder_ / "lab.key";
        EXPECT_EQ(run_thimble({"keygen", key.string()}).code, 0);
        ASSERT_TRUE(std::filesystem::exists(key));  // or under_lab_key would make it
        protection_ = under_lab_key(key);
    }

    std::string protection_;
    std::map<std::string, Child> nodes_;
};
std::string protection_name(const testing::TestParamInfo<Protection>& with) {
    constexpr std::array kNames{"Open", "UnderTheUserKey", "UnderALabKey"};
    return kNames.at(static_cast<std::size_t>(with.param));
}
INSTANTIATE_TEST_SUITE_P(, StandingNodes,
                         testing::Values(Protection::kNone, Protection::kUserKey, Protection::kLabKey),
                         protection_name);

TEST_P(StandingNodes, AreSteeredAgainAndAgain) {
    expect_a_trial("first");
    kill("thimble-slave-sim");
    start("thimble-slave-sim");
    const Outcome delayed = attach("delayed", "[netem.force]\ndelay_s = 0.05\n");
    EXPECT_EQ(delayed.code, 2) << delayed.words;
    EXPECT_THAT(delayed.words, testing::HasSubstr("forces came back sooner than this session file allows"));
    const Outcome sitting = attach("people",
                                   "[protocol]\nexperiments = [1]\ntrials_per_modality = 1\n"
                                   "practice_trials = 0\nbreak_every = 0\n",
                                   "--participant P01");
    EXPECT_EQ(sitting.code, 0) << sitting.words;
    expect_a_trial("last");
}

}  // namespace
}  // namespace thimble
