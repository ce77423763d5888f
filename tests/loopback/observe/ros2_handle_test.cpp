// [handle] device = "ros2": a session whose handle is a ROS 2 device, which is played by another DDS.
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <limits>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/runtime/wall_clock.hpp"
#include "tests/loopback/observe/fast_dds_peer.hpp"
#include "tests/loopback/real_run.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

// A thousand positions a second from a thread of its own, and the newest force.
class PlayedDevice {
  public:
    PlayedDevice() {
        setenv("ROS_DOMAIN_ID", std::to_string(own_domain()).c_str(), 1);
        thread_ = std::thread([this] { play(); });
    }
    ~PlayedDevice() {
        ended = true;
        thread_.join();
        unsetenv("ROS_DOMAIN_ID");
    }
    PlayedDevice(const PlayedDevice&) = delete;
    PlayedDevice& operator=(const PlayedDevice&) = delete;

    std::atomic<bool> inserts = false, talks_nonsense = false, silent = false, ended = false;
    std::atomic<double> force_N = 0;   // newest
    std::atomic<unsigned> forces = 0;  // that came

  private:
    void play() {
        auto* const positions = peer_.writer<HeardPose>("/thimble/handle/measured_cp");
        auto* const requests = peer_.reader<HeardWrench>("/thimble/handle/servo_cf");
        HeardPose::type pose;
        for (double z_m = 0; !ended; wall_sleep(std::chrono::milliseconds{1})) {
            if (inserts && z_m < kDeepest_m) z_m += kSpeed_m;
            pose.pose().position().z(z_m);
            if (!silent) positions->write(&pose);
            if (talks_nonsense) {
                for (int more = 0; more < 7; ++more) positions->write(&pose);
                for (const double nonsense : {std::numeric_limits<double>::quiet_NaN(), z_m + 0.5, 1e9}) {
                    pose.pose().position().z(nonsense);
                    positions->write(&pose);
                }
            }
            while (const auto force = take<HeardWrench>(requests)) {
                force_N = force->wrench().force().z();
                ++forces;
            }
        }
    }

    // The needle then is 36 mm deep, 1 mm in the fixture.
    static constexpr double kDeepest_m = 0.012, kSpeed_m = 2e-5;
    FastDdsPeer peer_;
    std::thread thread_;
};

SessionFile on_ros2() {
    SessionFile session = SessionFile::endless();
    session.more = "[handle]\ndevice = \"ros2\"\n";
    return session;
}

// Until the needle is felt.
void insert(PlayedDevice& device, RealRun& run) {
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    device.inserts = true;
    ASSERT_TRUE(wait_until([&] { return device.force_N < -0.3 || run.launcher().poll(); }));
    ASSERT_LT(device.force_N, -0.3) << run.words();
}

TEST(Ros2Handle, FeelsTheNeedleAndItsSilenceEndsTheTrialWithoutForce) {
    PlayedDevice device;
    RealRun run(on_ros2());
    insert(device, run);
    FastDdsPeer late;
    auto* const wrong_type = late.writer<HeardString>("/thimble/handle/measured_cp");
    auto* const forces = late.reader<HeardWrench>("/thimble/handle/servo_cf");
    HeardString::type text;
    bool known = false;  // the other side has discovered it
    device.talks_nonsense = true;
    const unsigned before = device.forces;
    double felt_N = 0;
    EXPECT_TRUE(wait_until([&] {
        wrong_type->write(&text);
        known = known || take<HeardWrench>(forces);
        felt_N = device.force_N;
        const bool stalled = felt_N == 0;  // 20 ms without a position: no force, until the next one
        return (known && device.forces > before + 400 && !stalled) || run.launcher().poll();
    }));
    EXPECT_LT(felt_N, -0.3) << "nonsense beside good positions changes nothing";
    device.talks_nonsense = false;
    device.silent = true;
    EXPECT_TRUE(wait_until([&] { return device.force_N == 0; }));
    expect_end(run, 1, EndReason::kDeviceFault,
               "the ROS 2 driver at /thimble/handle/measured_cp has sent no usable position");
    const auto counted = run.report("thimble-master").at("remote");
    EXPECT_GT(counted.at("positions"), 100);
    EXPECT_GT(counted.at("not_numbers"), 10);
    EXPECT_GT(counted.at("jumps"), 10);
    EXPECT_GT(counted.at("floods"), 10);
    EXPECT_THAT(counted.at("wrong_types").dump(),
                HasSubstr("has type std_msgs/msg/String, not geometry_msgs/msg/Pose"));
}

TEST(Ros2Handle, ASecondDeviceEndsTheTrialWithoutForce) {
    PlayedDevice device;
    RealRun run(on_ros2());
    insert(device, run);
    FastDdsPeer second;
    auto* const positions = second.writer<HeardPose>("/thimble/handle/measured_cp");
    HeardPose::type pose;
    EXPECT_TRUE(wait_until([&] {
        positions->write(&pose);
        return run.launcher().poll().has_value();
    }));
    EXPECT_EQ(device.force_N, 0);
    expect_end(run, 1, EndReason::kDeviceFault,
               "a second program sends positions beside the ROS 2 driver at /thimble/handle/measured_cp");
}

TEST(Ros2Handle, AnEmergencyStopTakesItsForce) {
    PlayedDevice device;
    RealRun run(on_ros2());
    insert(device, run);
    run.launcher().signal(SIGQUIT);
    EXPECT_TRUE(wait_until([&] { return device.force_N == 0; })) << "while it goes on to push";
    expect_end(run, 1, EndReason::kEmergencyStop, "emergency_stop");
}

TEST(Ros2Handle, RefusesToStartBesideAnotherMaster) {
    setenv("ROS_DOMAIN_ID", std::to_string(own_domain()).c_str(), 1);
    const Folder folder;
    const PortBlock ports;
    FastDdsPeer peer;
    peer.writer<HeardWrench>("/thimble/handle/servo_cf");
    auto* const positions = peer.writer<HeardPose>("/thimble/handle/measured_cp");
    Child master(built_programs() / "thimble-ros2-master",
                 {folder.write("session.toml", on_ros2().text()).string(), "--base-port",
                  std::to_string(ports.base())},
                 folder / "words");
    HeardPose::type pose;
    wait_until([&] {
        positions->write(&pose);
        return master.poll().has_value();
    });
    unsetenv("ROS_DOMAIN_ID");
    EXPECT_EQ(master.poll(), 2);
    EXPECT_THAT(read_text(folder / "words"), HasSubstr("another program sends on /thimble/handle/se"));
}

TEST(Ros2Handle, SaysWhichProgramAndWhichInterface) {
    const Folder folder;
    const auto session = folder.write("session.toml", on_ros2().text()).string();
    const auto program = built_programs();
    const auto without = run_to_end(program / "thimble-master", {session});
    EXPECT_EQ(without.code, 2);
    EXPECT_THAT(without.words, HasSubstr("thimble-ros2-master"));
    const auto units = run_to_end(program / "thimble", {"run", session, "--print", "systemd"});
    EXPECT_EQ(units.code, 2);
    EXPECT_THAT(units.words, HasSubstr("no unit for thimble-ros2-master"));
    std::filesystem::copy(program / "thimble", folder / "thimble");
    const auto alone = run_to_end(folder / "thimble", {"check", session});
    EXPECT_EQ(alone.code, 2);
    EXPECT_THAT(alone.words, HasSubstr("install the package thimble-ros2"));
    const auto other = folder.write("other.toml", SessionFile{}.text()).string();
    EXPECT_EQ(run_to_end(program / "thimble-ros2-master", {other}).code, 2);
    const auto far = folder.write("far.toml", on_ros2().text() + "[handle.ros2]\ninterface = '192.0.2.1'\n");
    const auto refused = run_to_end(program / "thimble-ros2-master", {far.string()});
    EXPECT_EQ(refused.code, 2);
    EXPECT_THAT(refused.words, HasSubstr("'192.0.2.1' is not this machine alone"));
}

}  // namespace
}  // namespace thimble
