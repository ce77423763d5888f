// The master writes the cycle time into each drive.
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/queue_channel.hpp"
#include "cutaneous_node/can/cannelloni.hpp"
#include "cutaneous_node/drive_actuator.hpp"
#include "cutaneous_node/emulator/emulated_drives.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

DriveSettings drives_of(const std::string& text) {
    const ConfigFile file = ConfigFile::parse("[drives]\nbus = \"can0\"\n" + text, "drives.toml");
    return read_drive_settings(file.table("drives"));
}

struct StartedDrives {
    explicit StartedDrives(const std::string& text, const std::string& fault = "")
        : settings(drives_of(text)), drives(settings.master.nodes, PlantParameters{}, far) {
        EXPECT_EQ(drives.obey({}, fault), "");
        DriveActuator actuator(settings, 1.5, near);
        for (SessionTime now{}; !actuator.ready() && actuator.fault().empty() && now < at(seconds{10});) {
            now += milliseconds{1};
            actuator.tick(now);
            drives.tick(now);
        }
        ready = actuator.ready();
        words = actuator.fault();
    }

    QueuePipe pipe;
    CannelloniBus near{pipe.a}, far{pipe.b};
    DriveSettings settings;
    EmulatedDrives drives;
    bool ready = false;
    std::string words;
};

TEST(DriveCycle, ByPositionEachDriveIsToldForHowLongToInterpolate) {
    const StartedDrives by_4_ms("mode = \"position\"");
    ASSERT_TRUE(by_4_ms.ready) << by_4_ms.words;
    for (std::size_t i = 0; i < 12; ++i) {
        EXPECT_EQ(by_4_ms.drives.drive(i).object({0x1006, 0}), 4000U);
        EXPECT_EQ(by_4_ms.drives.drive(i).object({0x60c2, 1}), 4U);
        EXPECT_EQ(by_4_ms.drives.drive(i).object({0x60c2, 2}), 0xfdU) << "10^-3";
    }
    const StartedDrives by_fractions("mode = \"position\"\ncycle_s = 0.0025");
    ASSERT_TRUE(by_fractions.ready) << by_fractions.words;
    EXPECT_EQ(by_fractions.drives.drive(0).object({0x1006, 0}), 2500U);
    EXPECT_EQ(by_fractions.drives.drive(0).object({0x60c2, 1}), 25U);
    EXPECT_EQ(by_fractions.drives.drive(0).object({0x60c2, 2}), 0xfcU) << "10^-4";
}

TEST(DriveCycle, ByTorqueThereIsNothingToInterpolate) {
    const StartedDrives by_torque("");
    ASSERT_TRUE(by_torque.ready) << by_torque.words;
    EXPECT_EQ(by_torque.drives.drive(0).object({0x1006, 0}), 0U);
    EXPECT_EQ(by_torque.drives.drive(0).object({0x60c2, 1}), 1U);
}

TEST(DriveCycle, ADriveWithoutTheObjectsGoesOn) {
    for (const char* lacks : {"refuse 3 0x1006", "refuse 3 0x60c2 1", "refuse 3 0x60c2 2"}) {
        const StartedDrives started("mode = \"position\"", lacks);
        EXPECT_TRUE(started.ready) << lacks << ": " << started.words;
    }
}

TEST(DriveCycle, ATimeIsSaidInTheLargestUnitThatFits) {
    const auto said = [](Duration cycle) {
        const auto time = interpolation_time(cycle);
        return time ? std::pair<int, int>{time->count, time->exponent} : std::pair<int, int>{};
    };
    EXPECT_EQ(said(milliseconds{1}), (std::pair{1, -3}));
    EXPECT_EQ(said(milliseconds{100}), (std::pair{100, -3}));
    EXPECT_EQ(said(microseconds{500}), (std::pair{5, -4}));
    EXPECT_EQ(said(microseconds{1250}), (std::pair{125, -5}));
    EXPECT_EQ(said(microseconds{2560}), (std::pair<int, int>{})) << "256 hundredths";
    EXPECT_EQ(said(Duration{0}), (std::pair<int, int>{}));
    EXPECT_THROW(drives_of("mode = \"position\"\ncycle_s = 0.00256"), Error);
    EXPECT_EQ(drives_of("cycle_s = 0.00256").master.cycle, microseconds{2560}) << "by torque";
}

}  // namespace
}  // namespace thimble
