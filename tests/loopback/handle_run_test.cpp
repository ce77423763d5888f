// A trial with a real handle's driver in the real master: Force Dimension's, with a library of our own behind it that plays a hand.
#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/loopback/lone_node.hpp"
#include "tests/loopback/real_run.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

class HandleRun : public testing::Test {
  protected:
    // The hand goes in and out again once in 2000 reads, `press` metres deep.
    SessionFile session(const std::string& script) {
        const auto path = folder_.write("script", "log " + (folder_ / "log").string() + '\n' + script);
        setenv("THIMBLE_FAKE_DHD", path.c_str(), 1);
        SessionFile file;
        file.contact_hold_s = 0.3;
        file.more =
            "[handle]\ndevice = \"force-dimension\"\n[handle.force_dimension]\nlibrary = "
            "\"" THIMBLE_FAKE_DHD_FILE "\"\n";
        return file;
    }
    std::string device_log() const { return read_text(folder_ / "log"); }

    Folder folder_;
};

TEST_F(HandleRun, APersonsTrialEndsWhenTheNeedleIsWithdrawn) {
    RealRun run(session("press 0.02\n"));
    EXPECT_EQ(run.end(), 0) << run.words();
    ASSERT_EQ(run.only_reason(), EndReason::kCompleted);
    EXPECT_GT(run.rows()[0].metrics.penetration_max_m, 0.02);
    EXPECT_EQ(run.report("thimble-master")["handle"]["device"], "omega.3, serial 1001, SDK 3.17.0.0");
    // The fixture is hard: the device's limit was reached, and pushed out along its x.
    EXPECT_THAT(device_log(), HasSubstr("force 12.000 0.000 0.000"));
    EXPECT_THAT(device_log(), testing::EndsWith("stop\nclose\n"));
}

TEST_F(HandleRun, AnUnpluggedHandleEndsTheTrialInItsOwnWords) {
    SessionFile file = session("press 0.02\nunplugged_after 600\n");
    file.delays_s = "[0.0, 0.05]";
    file.parallel_conditions = 2;  // but there is one device: the second delay would come after the first
    RealRun run(file);
    EXPECT_EQ(run.first_trial_end(), "# ended: device_fault_master");
    EXPECT_EQ(run.end(), 1) << run.words();
    EXPECT_THAT(run.words(), HasSubstr("the device of master failed: omega.3, serial 1001"));
    EXPECT_THAT(run.words(), HasSubstr("communication error (error 2); is it still plugged in"));
    ASSERT_EQ(run.rows().size(), 1U);
    EXPECT_EQ(outcome_text(run.rows()[0].reason, run.rows()[0].lost_peer), "device_fault_master");
    EXPECT_FALSE(read_trajectory(run.trajectory_path(run.rows()[0].conditions)).samples.empty());
    EXPECT_THAT(read_text(run.out() / "report.html"), HasSubstr("communication error"));
}

TEST_F(HandleRun, WithoutItsLibraryTheMasterSaysWhereItLooked) {
    LoneNode node("thimble-master",
                  "[handle]\ndevice = \"force-dimension\"\n[handle.force_dimension]\nlibrary = "
                  "\"/nowhere/libdhd.so.3\"\n");
    EXPECT_EQ(node.process().wait(kPatience).value_or(-1), 2);
    EXPECT_THAT(node.words(), HasSubstr("/nowhere/libdhd.so.3: cannot open shared object file"));
}

}  // namespace
}  // namespace thimble
