// The actuator over emulated drives: bringing up, pressing, and every fault on command.
#include <algorithm>
#include <cmath>
#include <deque>
#include <ostream>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/cutaneous_node/drive_bench.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;

TEST(DriveActuator, BringsTwelveDrivesUpAndTheirCablesTaut) {
    ReadyDrives bench;
    EXPECT_LT(bench.now, SessionTime{seconds{3}});
    for (std::size_t i = 0; i < 12; ++i) {
        EXPECT_EQ(bench.drives.drive(i).state(), DriveState::kOperationEnabled);
        EXPECT_NEAR(bench.drives.drive(i).plant().tension_N(), 0.03, 0.005) << i;
        EXPECT_EQ(bench.drives.drive(i).object({0x1800, 1}), 0x40000181U + i) << "no remote frames";
    }
    EXPECT_EQ(bench.actuator.output(bench.now).finger, Finger::kNone);
}

TEST(DriveActuator, PressesTheFingerThatIsAskedForAndSaysWhatIsMeasured) {
    ReadyDrives bench;
    bench.press(Finger::kThumb, 1.0, milliseconds{500});
    EXPECT_NEAR(bench.drives.force_N(1), 1.0 + 3 * 0.03 * std::cos(0.35), 0.03);
    EXPECT_LT(bench.drives.force_N(0), 0.1);
    const FingertipForce felt = bench.actuator.output(bench.now);
    EXPECT_EQ(felt.finger, Finger::kThumb);
    EXPECT_NEAR(felt.force_N, 1.0, 0.01);
    EXPECT_LE(bench.now - felt.sample_time, milliseconds{5});
    bench.press(Finger::kIndex, 9.0, milliseconds{500});
    EXPECT_NEAR(bench.felt_N(), 1.5, 0.01) << "the limit";
    EXPECT_LT(bench.drives.force_N(1), 0.1) << "the other finger is let go";
    bench.actuator.release(bench.now);
    bench.run(milliseconds{200});
    EXPECT_EQ(bench.actuator.output(bench.now).finger, Finger::kNone);
    EXPECT_EQ(bench.fault(), "");
}

// A heartbeat each 3.3 s is the answer to the start.
TEST(DriveActuator, ADriveWithASlowHeartbeatIsWaitedFor) {
    const ReadyDrives bench("silent_after_s = 10");
    EXPECT_GT(bench.now, SessionTime{seconds{3}});
}

// A finger is released. In every third millisecond of that both processes, or the drives alone, stand still for 90
// ms.
TEST(DriveActuator, AStalledMachineIsNoSlackCable) {
    for (int stalls_after_ms = 0; stalls_after_ms < 40; stalls_after_ms += 3) {
        for (const bool drives_alone : {false, true}) {
            ReadyDrives bench("silent_after_s = 3");
            bench.press(Finger::kIndex, 1.5, milliseconds{300});
            bench.actuator.release(bench.now);
            bench.run(milliseconds{stalls_after_ms});
            bench.stall(milliseconds{90}, drives_alone);
            bench.run(milliseconds{100});
            EXPECT_EQ(bench.fault(), "") << stalls_after_ms << " ms, alone " << drives_alone;
        }
    }
}

// 225 answers come at once, after a silence that this session allows.
TEST(DriveActuator, DrivesThatStoodStillAreNoSecondDevices) {
    ReadyDrives bench("silent_after_s = 3");
    bench.stall(milliseconds{900}, true);
    bench.run(milliseconds{100});
    EXPECT_EQ(bench.fault(), "");
}

// Brought up, and the motors have come to rest.
struct PositionBench : ReadyDrives {
    PositionBench() : ReadyDrives("mode = \"position\"") { run(milliseconds{500}); }
};

TEST(DriveActuator, ByPositionTakeUpEndsAtPretension) {
    PositionBench bench;
    for (std::size_t finger = 0; finger < 4; ++finger)
        EXPECT_NEAR(bench.drives.force_N(finger), bench.settings.resting_N(), 0.04) << finger;
    EXPECT_LT(bench.felt_N(), 0.05);
}

// An emulated motor swings past its position, more in relation if the force is small.
TEST(DriveActuator, ByPositionThePadsModelMakesTheForceOfTheFirstMoment) {
    for (const double force_N : {0.1, 1.0}) {
        PositionBench bench;
        const double resting_N = bench.drives.force_N(0);
        double most_N = 0;
        for (int ms = 0; ms < 60; ++ms) {
            bench.press(Finger::kIndex, force_N, milliseconds{1});
            most_N = std::max(most_N, bench.drives.force_N(0) - resting_N);
        }
        EXPECT_GT(most_N, 0.7 * force_N);
        EXPECT_LT(most_N, force_N + 0.15);
    }
}

TEST(DriveActuator, ByPositionAHeldFingerRelaxesAndIsStillFelt) {
    PositionBench bench;
    bench.press(Finger::kIndex, 1.0, milliseconds{600});
    EXPECT_EQ(bench.actuator.output(bench.now).finger, Finger::kIndex);
    EXPECT_GT(bench.felt_N(), 0.3);
    EXPECT_LT(bench.felt_N(), 0.7);
    EXPECT_EQ(bench.fault(), "");
}

// The other hand's finger, and a reversed motor: the same to the finger.
TEST(DriveActuator, WhicheverDrivesPullTheForceIsTheSame) {
    for (const bool reversed : {false, true}) {
        PlantParameters plant;
        plant.cable.reversed = reversed;
        ReadyDrives bench(reversed ? "reversed = true" : "", plant);
        bench.actuator.use_hand(bench.now, reversed ? Hand::kActing : Hand::kOther);
        bench.press(Finger::kIndex, 1.0, milliseconds{300});
        EXPECT_NEAR(bench.felt_N(), 1.0, 0.01);
        EXPECT_NEAR(bench.drives.force_N(reversed ? 0 : 2), 1.09, 0.05);
        EXPECT_LT(bench.drives.force_N(reversed ? 2 : 0), 0.1);
        EXPECT_EQ(bench.actuator.output(bench.now).finger, Finger::kIndex);
    }
}

struct FaultCase {
    const char* words;
    const char* said;
    int within_ms = 0;  // from the fault to no torque at the drives that still listen
};

void PrintTo(const FaultCase& fault, std::ostream* out) { *out << fault.words; }

class DriveFaults : public testing::TestWithParam<FaultCase> {};

TEST_P(DriveFaults, CablesGoSlackAndTheFaultIsNamed) {
    ReadyDrives bench;
    bench.press(Finger::kIndex, 1.0, milliseconds{300});
    ASSERT_GT(bench.drives.force_N(0), 0.9);
    bench.order(GetParam().words);
    const SessionTime since = bench.now;
    while (bench.fault().empty() && bench.now - since < seconds{1}) {
        bench.press(Finger::kIndex, 1.0, milliseconds{1});
    }
    EXPECT_THAT(bench.fault(), HasSubstr(GetParam().said));
    EXPECT_LE(bench.now - since, milliseconds{GetParam().within_ms});
    // Two ticks later no drive gets a target, although the commands go on.
    bench.press(Finger::kIndex, 1.0, milliseconds{2});
    EXPECT_EQ(bench.felt_N(), 0);
    for (const std::size_t drive : {0U, 1U}) {
        EXPECT_NE(bench.drives.drive(drive).state(), DriveState::kOperationEnabled) << drive;
    }
    bench.press(Finger::kIndex, 1.0, milliseconds{300});
    EXPECT_LT(bench.drives.drive(0).plant().force_N(), 0.05);
}

INSTANTIATE_TEST_SUITE_P(
    Each, DriveFaults,
    testing::Values(
        FaultCase{"emcy 3 0x2310",
                  "drive 3 (acting hand, index, cable 2): EMCY 0x2310 (over-current); remove the cause", 2},
        FaultCase{"reboot 3", "drive 3 (acting hand, index, cable 2): has restarted", 2},
        FaultCase{"no-heartbeat 3", "drive 3 (acting hand, index, cable 2): its heartbeat is lost", 102},
        FaultCase{"silence 3", "drive 3 (acting hand, index, cable 2): its heartbeat is lost", 102},
        FaultCase{"no-data 3", "sends no process data", 206},
        FaultCase{"short-data 3", "process data of 6 bytes, not 8", 6},
        FaultCase{"duplicate 3", "drive 3 (acting hand, index, cable 2): two devices have this node id", 40},
        FaultCase{"cut 3", "drive 3 (acting hand, index, cable 2): the cable is slack or broken", 300},
        FaultCase{"emcy 12 0x4210", "drive 12 (other hand, thumb, cable 2): EMCY 0x4210 (too hot)", 2}));

// Notes the target of drive 1. If `full`, it loses the last frame of each cycle, the SYNC, as an interface's queue of 10 frames does.
class WatchedBus final : public CanBus {
  public:
    explicit WatchedBus(CanBus& bus) : bus_(&bus) {}
    void send(const CanFrame& frame) override {
        if (frame.id == 0x201U) target_per_mille = static_cast<std::int16_t>(load(frame, 2, 2));
        const bool lost = full && frame.id == sync_frame().id;
        ++(lost ? counters_.send_failed : counters_.sent);
        if (!lost) bus_->send(frame);
    }
    void flush() override { bus_->flush(); }
    bool receive(SessionTime at, CanFrame& frame) override {
        for (CanFrame next; bus_->receive(at, next);) answers_.emplace_back(at + late, next);
        if (answers_.empty() || answers_.front().first > at) return false;
        frame = answers_.front().second;
        answers_.pop_front();
        return true;
    }
    bool down() const override { return bus_->down(); }

    bool full = false;
    int target_per_mille = 0;
    Duration late{};  // what the drives answer from now on

  private:
    CanBus* bus_;
    std::deque<std::pair<SessionTime, CanFrame>> answers_;
};

struct WatchedQueue : DriveQueue {
    WatchedBus bus{near_};
    CanBus& near_end() { return bus; }
};

// Presses, brought up, on a bus that is watched.
struct WatchedBench : DriveBench<WatchedQueue> {
    explicit WatchedBench(const std::string& more = "") : DriveBench(more) {
        EXPECT_TRUE(come_up()) << fault();
        press(Finger::kIndex, 1, milliseconds{300});
        EXPECT_GT(bus.target_per_mille, 400);
    }
};

// A busy machine delays the answers more and more while a finger is released.
TEST(DriveActuator, LateAnswersAreNoSlackCable) {
    WatchedBench bench("silent_after_s = 3");
    bench.press(Finger::kIndex, 1.5, seconds{2});
    bench.actuator.release(bench.now);
    for (int i = 0; i < 30; ++i) {
        bench.bus.late += std::chrono::microseconds{1500};
        bench.tick();
    }
    bench.run(milliseconds{300});
    EXPECT_EQ(bench.fault(), "");
}

// Long before it counts as dead: the others stop pressing.
TEST(DriveActuator, ADriveThatDoesNotAnswerCostsTheForceInTwoCycles) {
    for (const char* fault : {"silence 3", "no-data 3"}) {
        WatchedBench bench("silent_after_s = 0.5");
        bench.order(fault);
        bench.press(Finger::kIndex, 1, 3 * bench.settings.master.cycle + milliseconds{1});
        EXPECT_EQ(bench.fault(), "") << "not yet";
        EXPECT_LT(bench.bus.target_per_mille, 50) << fault;
    }
}

TEST(DriveActuator, AQueueThatIsTooShortIsNamed) {
    WatchedBench bench;
    bench.bus.full = true;
    bench.press(Finger::kIndex, 1, milliseconds{16});
    EXPECT_EQ(bench.fault(), "") << "it may have been for a moment";
    bench.press(Finger::kIndex, 1, milliseconds{10});
    EXPECT_THAT(bench.fault(), HasSubstr("ip link set can0 txqueuelen 100"));
}

// Frames that do not belong here: other identifiers, lengths, kinds. All of it is passed over.
TEST(DriveActuator, FramesThatAreNobodysChangeNothing) {
    ReadyDrives bench;
    for (int i = 0; i < 300; ++i) {
        CanFrame stray;
        stray.id =
            i % 3 == 0 ? 0x18dU + static_cast<unsigned>(i) % 0x60U : 0x7e0U + static_cast<unsigned>(i) % 16U;
        if (i % 5 == 1) stray.id = kCanExtended | (0x181U + static_cast<unsigned>(i) % 12U);
        if (i % 5 == 2) stray.id = kCanRemote | (0x181U + static_cast<unsigned>(i) % 12U);
        stray.length = static_cast<std::uint8_t>(i % 9);
        stray.data.fill(static_cast<std::uint8_t>(i));
        bench.far_.send(stray);
        bench.press(Finger::kIndex, 1.0, milliseconds{1});
    }
    EXPECT_EQ(bench.fault(), "");
    EXPECT_NEAR(bench.felt_N(), 1.0, 0.01);
}

TEST(DriveActuator, ABusThatIsOffIsNamedAndTheDrivesHelpThemselves) {
    ReadyDrives bench;
    bench.press(Finger::kIndex, 1.0, milliseconds{300});
    bench.far_.send({.id = kCanError | 0x40});
    bench.far_.flush();
    bench.tick();
    EXPECT_THAT(bench.fault(), HasSubstr("can0: bus-off; check termination"));
    // Nothing gets through any more: what stops the drives is the master's heartbeat that they miss.
    ReadyDrives lonely;
    lonely.press(Finger::kIndex, 1.0, milliseconds{300});
    lonely.drives_alone(milliseconds{400});
    EXPECT_EQ(lonely.drives.drive(0).state(), DriveState::kFault);
    EXPECT_LT(lonely.drives.force_N(0), 0.05);
}

class DriveStartFaults : public testing::TestWithParam<FaultCase> {};

TEST_P(DriveStartFaults, AreNamedWithTheirStep) {
    DriveBench bench;
    bench.order(GetParam().words);
    EXPECT_FALSE(bench.come_up());
    EXPECT_THAT(bench.fault(), HasSubstr(GetParam().said));
    EXPECT_LE(bench.fault().size(), sizeof(DeviceFault::text)) << "fits into a message";
}

INSTANTIATE_TEST_SUITE_P(
    Each, DriveStartFaults,
    testing::Values(
        FaultCase{"refuse 3 0x6060",
                  "drive 3 (acting hand, index, cable 2): rejected 'mode 0x6060' with SDO abort 0x06020000 "
                  "(no such object)"},
        FaultCase{"refuse 7 0x1a00 2", "drive 7 (other hand, index, cable 0): rejected 'TPDO1 position'"},
        FaultCase{"duplicate 3", "drive 3 (acting hand, index, cable 2): two devices have this node id"},
        FaultCase{"cut 5", "drive 5 (acting hand, thumb, cable 1): the cable does not become taut"}));

TEST(DriveFaultWords, AWrongOneIsRefusedAlsoForLater) {
    DriveBench bench;
    for (const char* wrong : {"emyc 9 0x4210", "emcy 99 0x4210", "emcy 3", "emcy 3 0x12310", "emcy 3 7 7",
                              "refuse 3 0x16060", "refuse 3 0x6060 256", "silence 3 1", "cut"}) {
        EXPECT_THAT(bench.drives.obey(bench.now, wrong), HasSubstr("unknown command or drive")) << wrong;
        EXPECT_THAT(bench.drives.obey_when_pressed(wrong, {}), HasSubstr(wrong));
    }
    EXPECT_EQ(bench.drives.obey_when_pressed("emcy 9 0x4210", {}), "");
}

// The first tick resets the drives.
TEST(DriveFaultWords, AtTheStartOnlyThoseThatOutlastAReset) {
    DriveBench bench;
    for (const char* ends : {"emcy 3 0x2310", "silence 3", "no-heartbeat 3", "no-data 3", "short-data 3"})
        EXPECT_THAT(bench.drives.obey(bench.now, ends), HasSubstr("use --fault-when-pressed")) << ends;
    bench.order("bus-off");
    bench.drives.tick(bench.now);
    CanFrame frame;
    ASSERT_TRUE(bench.near_.receive(bench.now, frame));
    EXPECT_EQ(frame.id, kCanError | 0x40U);
    EXPECT_FALSE(bench.near_.receive(bench.now, frame)) << "no boot-up on a bus that is off";
}

TEST(DriveActuator, ADriveThatIsNotThereIsNamed) {
    DriveBench bench;
    DriveActuator actuator(drive_settings("other_thumb = [10, 11, 13]"), 1.5, bench.near_);
    for (int ms = 0; ms < 4000 && actuator.fault().empty(); ++ms) {
        actuator.tick(bench.now += milliseconds{1});
        bench.drives.tick(bench.now);
    }
    EXPECT_THAT(std::string(actuator.fault()), HasSubstr("drive 13 (other hand, thumb, cable 2): no boot-up "
                                                         "message on can0 after its reset; check its power"));
}

TEST(DriveActuator, AFingerWithoutADeviceIsAFaultOnlyWhenItIsPressed) {
    ReadyDrives bench("other_index = []\nother_thumb = []");
    bench.actuator.use_hand(bench.now, Hand::kOther);
    bench.run(milliseconds{10});
    EXPECT_EQ(bench.fault(), "");
    bench.press(Finger::kThumb, 0.001, milliseconds{2});
    EXPECT_EQ(bench.fault(), "") << "less than deadband_N is no force";
    bench.press(Finger::kIndex, 1.0, milliseconds{2});
    EXPECT_THAT(bench.fault(), HasSubstr("no device for a finger"));
}

TEST(DriveActuator, StopLeavesNobodyPressed) {
    ReadyDrives bench;
    bench.press(Finger::kIndex, 1.0, milliseconds{300});
    bench.actuator.stop();
    bench.drives_alone(milliseconds{50});
    for (std::size_t i = 0; i < 12; ++i)
        EXPECT_EQ(bench.drives.drive(i).state(), DriveState::kSwitchOnDisabled) << i;
    bench.drives_alone(milliseconds{250});
    EXPECT_LT(bench.drives.force_N(0), 0.05);
}

// The master writes the cycle time into each drive, which interpolates for so long.
TEST(DriveCycle, ByPositionEachDriveIsToldForHowLongToInterpolate) {
    struct Case {
        const char* text;
        std::uint32_t cycle_us, count, unit;
    };
    for (const Case& c : {Case{"mode = \"position\"", 4000, 4, 0xfd},
                          {"mode = \"position\"\ncycle_s = 0.0025", 2500, 25, 0xfc},
                          {"", 0, 1, 0xfd}}) {
        const ReadyDrives bench(c.text);
        for (std::size_t i = 0; i < 12; ++i) {
            EXPECT_EQ(bench.drives.drive(i).object({0x1006, 0}), c.cycle_us) << c.text;
            EXPECT_EQ(bench.drives.drive(i).object({0x60c2, 1}), c.count) << c.text;
            EXPECT_EQ(bench.drives.drive(i).object({0x60c2, 2}), c.unit) << c.text;
        }
    }
}

TEST(DriveCycle, ADriveWithoutTheObjectsGoesOn) {
    for (const char* lacks : {"refuse 3 0x1006", "refuse 3 0x60c2 1", "refuse 3 0x60c2 2"}) {
        DriveBench bench("mode = \"position\"");
        bench.order(lacks);
        EXPECT_TRUE(bench.come_up()) << lacks << ": " << bench.fault();
    }
}

}  // namespace
}  // namespace thimble
