// Sessions whose fingers are pressed by twelve emulated drives on one bus.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/allocation_count.hpp"
#include "tests/scenario/rig.hpp"
#include "tests/scenario/trials.hpp"

namespace thimble::test {
namespace {

// As the program does before it says that it is ready.
constexpr SessionTime kBroughtUp{std::chrono::seconds{3}};

SystemSettings with_drives() {
    SystemSettings settings = paper();
    settings.cutaneous.device = FingertipDevice::kDrives;
    settings.cutaneous.drives.bus = "can0";
    settings.session.contact_hold = settings.slave.contact_hold = std::chrono::milliseconds{500};
    return settings;
}

TEST(DrivenFingers, ATrialIsCompletedByWhatTheyFeel) {
    for (const Modality modality : {Modality::kCF, Modality::kCCF}) {
        Rig rig(with_drives());
        rig.run_until(kBroughtUp);
        const TrialRecord& record = rig.run(trial_of(modality));
        EXPECT_EQ(record.reason, EndReason::kCompleted) << record.fault;
        const std::size_t hand = modality == Modality::kCF ? 0 : 2;
        EXPECT_GT(rig.drives().strongest_N(), 0.3);
        for (std::size_t finger = 0; finger < 4; ++finger) {
            EXPECT_LT(rig.drives().force_N(finger), 0.15) << "let go at the end: " << finger;
        }
        EXPECT_EQ(rig.drives().drive(3 * hand).state(), DriveState::kOperationEnabled);
    }
}

TEST(DrivenFingers, NothingIsAllocatedWhileTheyArePressed) {
    Rig rig(with_drives());
    rig.run_until(kBroughtUp);
    rig.start(trial_of(Modality::kCF));
    ASSERT_TRUE(rig.run_until_sample([&](const TrajectorySample&) { return rig.drives().force_N(0) > 0.3; }));
    const std::uint64_t before = allocation_count();
    EXPECT_EQ(rig.finish().reason, EndReason::kCompleted);
    EXPECT_EQ(allocation_count() - before, 0U);
}

TEST(DrivenFingers, AFaultInATrialEndsItWithItsWords) {
    Rig rig(with_drives());
    rig.run_until(kBroughtUp);
    rig.start(trial_of(Modality::kCF));
    ASSERT_TRUE(rig.run_until_sample([&](const TrajectorySample&) { return rig.drives().force_N(0) > 0.3; }));
    rig.order_drives("emcy 2 0x2310");
    const SessionTime since = rig.now();
    const TrialRecord& record = rig.finish();
    EXPECT_EQ(record.reason, EndReason::kDeviceFault);
    EXPECT_EQ(record.lost_peer, Role::kCutaneous);
    EXPECT_FALSE(record.samples.empty());
    EXPECT_THAT(record.fault,
                testing::HasSubstr("drive 2 (acting hand, index, cable 1): EMCY 0x2310 (over-current)"));
    // The trial was given up in the tick in which the bus said it, and the session heard of it in the same instant.
    EXPECT_LT(rig.now() - since, std::chrono::milliseconds{100});
    EXPECT_EQ(rig.drives().drive(0).state(), DriveState::kSwitchOnDisabled);
    rig.start(trial_of(Modality::kCCF, {}, 1, 2));
    EXPECT_EQ(rig.finish().reason, EndReason::kDeviceFault) << "no trial that needs a device that has failed";
    rig.start(trial_of(Modality::kVF, {}, 1, 3));
    EXPECT_EQ(rig.finish().reason, EndReason::kCompleted) << "the others do without";
}

}  // namespace
}  // namespace thimble::test
