// A node that dies or freezes in mid-trial: the others end the trial, what was recorded is kept, the culprit
// is named.
#include <csignal>
#include <ostream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/runtime/wall_clock.hpp"
#include "tests/loopback/real_run.hpp"

namespace thimble {
namespace {

struct Victim {
    const char* program;
    Role role;
};

// The name that ctest shows. Without it ctest would show the bytes of a pointer, others in every run.
std::ostream& operator<<(std::ostream& out, const Victim& victim) { return out << victim.program; }

// Promised is about a second. Waiting for the dead to acknowledge the end would take five.
constexpr Duration kGivenUpWithin = std::chrono::seconds{4};

void expect_lost(RealRun& run, const Victim& victim) {
    const std::string outcome = outcome_text(EndReason::kPeerLost, victim.role);
    EXPECT_EQ(outcome, std::string("peer_lost_") + to_string(victim.role));
    EXPECT_EQ(run.first_trial_end(), "# ended: " + outcome);
    EXPECT_EQ(run.end(), 3) << run.words();
    const auto rows = run.rows();
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(outcome_text(rows.front().reason, rows.front().lost_peer), outcome);
    EXPECT_FALSE(read_trajectory(run.trajectory_path(rows.front().conditions)).samples.empty());
    EXPECT_TRUE(std::filesystem::exists(run.out() / "report.html"));
    EXPECT_THAT(nodes_alive(run.base_port()), testing::IsEmpty());
}

class KilledNode : public testing::TestWithParam<Victim> {};

TEST_P(KilledNode, EndsTheTrialWithItsNameOnRecord) {
    RealRun run(SessionFile::endless());
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    const pid_t victim = run.node(GetParam().program);
    const SessionTime killed_at = wall_now();
    kill(victim, SIGKILL);
    EXPECT_THAT(run.first_trial_end(), testing::StartsWith("# ended: "));
    EXPECT_LT(wall_now() - killed_at, kGivenUpWithin);
    expect_lost(run, GetParam());
    EXPECT_THAT(run.words(), testing::HasSubstr(std::string(GetParam().program) + " ended with code 137"));
    for (const char* program : kNodePrograms) {
        EXPECT_EQ(run.report(program).is_null(), program == std::string(GetParam().program)) << program;
    }
}

INSTANTIATE_TEST_SUITE_P(Each, KilledNode,
                         testing::Values(Victim{"thimble-netem", Role::kNetem},
                                         Victim{"thimble-slave-sim", Role::kSlaveSim},
                                         Victim{"thimble-cutaneous", Role::kCutaneous},
                                         Victim{"thimble-visual", Role::kVisual},
                                         Victim{"thimble-master", Role::kMaster}),
                         [](const auto& victim) { return std::string(to_string(victim.param.role)); });

// Without netem the others hear nothing of each other and all complain; the silent one is the culprit.
TEST(FrozenNode, IsFoundByItsSilence) {
    RealRun run(SessionFile::endless());
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    const pid_t netem = run.node("thimble-netem");
    kill(netem, SIGSTOP);
    EXPECT_EQ(run.first_trial_end(), "# ended: peer_lost_netem");
    kill(netem, SIGCONT);  // or the launcher waits for it in vain, some seconds long
    expect_lost(run, {"thimble-netem", Role::kNetem});
    EXPECT_THAT(run.words(), testing::HasSubstr("lost contact with netem"));
}

}  // namespace
}  // namespace thimble
