// Sessions in other scenes than the paper's, and by other solvers than the exact one.
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "tests/scenario/rig.hpp"
#include "tests/scenario/trials.hpp"

namespace thimble::test {
namespace {

SystemSettings with_slave(const std::string& keys) {
    return read_system_settings(ConfigFile::parse("[slave_sim]\n" + keys, "session.toml"));
}

double strongest_tissue_N(const TrialRecord& record) {
    double strongest_N = 0;
    for (const TrajectorySample& s : record.samples) {
        strongest_N = std::max(strongest_N, std::abs(s.force_tissue_N));
    }
    return strongest_N;
}

TEST(SceneInASession, AVesselOnTheWayIsFelt) {
    Rig plain(paper());
    const TrialRecord without = plain.run(trial_of(Modality::kCF));
    Rig rig(with_slave("scene = 'vessel.toml'\n"));
    const TrialRecord with = rig.run(trial_of(Modality::kCF));
    ASSERT_EQ(without.reason, EndReason::kCompleted);
    ASSERT_FALSE(with.samples.empty());
    EXPECT_GT(strongest_tissue_N(with), strongest_tissue_N(without) + 0.1);
}

// At 10 us the rules are as good as exact for a whole trial: the same end, at the same time within a sample or two.
TEST(SceneInASession, EverySolverRunsATrial) {
    Rig exact(paper());
    const TrialRecord reference = exact.run(trial_of(Modality::kHF));
    for (const char* solver : {"semi_implicit_euler", "rk4", "implicit_midpoint"}) {
        Rig rig(with_slave("solver = '" + std::string(solver) + "'\nsolver_step_s = 1e-5\n"));
        const TrialRecord record = rig.run(trial_of(Modality::kHF));
        EXPECT_EQ(record.reason, reference.reason) << solver;
        EXPECT_NEAR(record.beep_time_s, reference.beep_time_s, 0.01) << solver;
    }
}

}  // namespace
}  // namespace thimble::test
