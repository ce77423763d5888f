// [slave_sim] device = "ros2": a session whose needle a ROS 2 robot moves, which is played by another DDS.
#include <algorithm>
#include <atomic>
#include <cmath>
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

constexpr const char* kPlace = "/thimble/slave/measured_cp";
constexpr const char* kForce = "/thimble/slave/measured_cf";
constexpr double kStart_m = 0.004, kSurface_m = 0.01, kPush_N = -1.25;

// Follows orders with a lag, and feels kPush_N in its tissue. It sends both a thousand times a second.
class PlayedRobot {
  public:
    PlayedRobot() {
        setenv("ROS_DOMAIN_ID", std::to_string(own_domain()).c_str(), 1);
        thread_ = std::thread([this] { play(); });
    }
    ~PlayedRobot() {
        ended = true;
        thread_.join();
        unsetenv("ROS_DOMAIN_ID");
    }
    PlayedRobot(const PlayedRobot&) = delete;
    PlayedRobot& operator=(const PlayedRobot&) = delete;

    std::atomic<bool> hostile = false, silent = false, ended = false;
    std::atomic<double> first_m = -1, order_m = 0, furthest_m = 0, place_m = kStart_m;
    std::atomic<unsigned> orders = 0, repeated = 0;  // repeated: the newest orders that are the same

  private:
    void play() {
        auto* const places = peer_.writer<HeardPose>(kPlace);
        auto* const forces = peer_.writer<HeardWrench>(kForce);
        auto* const told = peer_.reader<HeardPose>("/thimble/slave/servo_cp");
        for (; !ended; wall_sleep(std::chrono::milliseconds{1})) {
            while (const auto order = take<HeardPose>(told)) obey(order->pose().position().z());
            if (orders > 0) place_m = place_m + 0.05 * (order_m - place_m);
            if (silent) continue;
            // Ten times as many as are asked for; NaN, a jump, a place on the moon.
            if (hostile) {
                for (int more = 0; more < 7; ++more) say(places, forces, place_m, push_N());
                for (const double wrong : {std::numeric_limits<double>::quiet_NaN(), place_m + 0.5, 4e8})
                    say(places, forces, wrong, wrong * 1e4);
            }
            say(places, forces, place_m, push_N());
        }
    }
    double push_N() const { return place_m > kSurface_m ? kPush_N : 0; }
    void obey(double z_m) {
        if (orders == 0) first_m = z_m;
        repeated = z_m == order_m ? repeated + 1 : 0;
        furthest_m = std::max<double>(furthest_m, std::fabs(z_m));
        order_m = z_m;
        ++orders;
    }
    static void say(dds::DataWriter* places, dds::DataWriter* forces, double z_m, double z_N) {
        HeardPose::type pose;
        pose.pose().position().z(z_m);
        places->write(&pose);
        HeardWrench::type wrench;
        wrench.wrench().force().z(z_N);
        forces->write(&wrench);
    }

    FastDdsPeer peer_;
    std::thread thread_;
};

SessionFile with_robot(const std::string& more = "") {
    SessionFile session = SessionFile::endless();
    session.more = "[slave_sim]\ndevice = \"ros2\"\n" + more;
    return session;
}

void insert(PlayedRobot& robot, RealRun& run) {
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    ASSERT_TRUE(wait_until([&] { return robot.place_m > kSurface_m + 0.005 || run.launcher().poll(); }));
    ASSERT_GT(robot.place_m, kSurface_m) << run.words();
}

double strongest_N(const RealRun& run) {
    double strongest = 0;
    for (const TrajectorySample& sample :
         read_trajectory(run.trajectory_path(run.only_row().conditions)).samples)
        strongest = std::min(strongest, sample.force_tissue_N);
    return strongest;
}

TEST(Ros2Slave, MovesTheNeedleIsFeltAndBearsAHostileRobotUntilItDies) {
    PlayedRobot robot;
    RealRun run(with_robot());
    insert(robot, run);
    EXPECT_EQ(robot.first_m, kStart_m) << "the first order is where it is";
    FastDdsPeer late;
    auto* const wrong_type = late.writer<HeardString>(kPlace);
    auto* const told = late.reader<HeardPose>("/thimble/slave/servo_cp");
    bool known = false;  // the other side has discovered it
    HeardString::type text;
    robot.hostile = true;
    const unsigned before = robot.orders;
    const double before_m = robot.order_m;
    EXPECT_TRUE(wait_until([&] {
        wrong_type->write(&text);
        known = known || take<HeardPose>(told);
        return (known && robot.orders > before + 400) || run.launcher().poll();
    }));
    EXPECT_LT(std::fabs(robot.order_m - before_m), 0.05) << "nonsense leads no needle";
    EXPECT_LT(robot.furthest_m, before_m + 0.05) << "nor did it meanwhile";
    robot.hostile = false;
    robot.silent = true;
    expect_end(run, 1, EndReason::kDeviceFault,
               "the ROS 2 robot at /thimble/slave/measured_cp has sent no usable position");
    EXPECT_EQ(strongest_N(run), kPush_N) << "and no other number was passed on";
    const auto counted = run.report("thimble-slave-sim").at("robot");
    EXPECT_GT(counted.at("position").at("taken"), 100);
    for (const char* input : {"position", "force"}) EXPECT_GT(counted.at(input).at("not_numbers"), 10);
    EXPECT_GT(counted.at("position").at("jumps"), 10);
    EXPECT_GT(counted.at("floods"), 10);
    EXPECT_THAT(counted.at("wrong_types").dump(),
                HasSubstr("has type std_msgs/msg/String, not geometry_msgs/msg/Pose"));
}

TEST(Ros2Slave, AnEmergencyStopHoldsItWhereItIs) {
    PlayedRobot robot;
    // So slow that a busy machine may take 2 s to hold it. From the stop to deepest_m it is 3 s.
    RealRun run(with_robot("[slave_sim.ros2]\ndeepest_m = 0.03\nspeed_limit_m_per_s = 0.005\n"));
    insert(robot, run);
    const double stop_m = robot.place_m;
    run.launcher().signal(SIGQUIT);
    expect_end(run, 1, EndReason::kEmergencyStop, "emergency_stop");
    const unsigned orders = robot.orders;
    EXPECT_LT(std::fabs(robot.order_m - stop_m), 0.01);
    wall_sleep(std::chrono::milliseconds{50});
    EXPECT_EQ(robot.orders, orders);
}

TEST(Ros2Slave, AProgramThatEndsInATrialSaysTheHoldMoreThanOnce) {
    PlayedRobot robot;
    RealRun run(with_robot());
    insert(robot, run);
    kill(run.node("thimble-ros2-slave"), SIGTERM);
    EXPECT_EQ(run.end(), 3) << run.words();
    EXPECT_GE(robot.repeated, 3U) << "one or the other may be lost";
}

TEST(Ros2Slave, ASecondRobotEndsTheTrial) {
    PlayedRobot robot;
    RealRun run(with_robot());
    insert(robot, run);
    FastDdsPeer second;
    auto* const forces = second.writer<HeardWrench>(kForce);
    HeardWrench::type wrench;
    EXPECT_TRUE(wait_until([&] {
        forces->write(&wrench);
        return run.launcher().poll().has_value();
    }));
    expect_end(run, 1, EndReason::kDeviceFault,
               "a second program sends beside the ROS 2 robot at /thimble/slave/measured_cf");
}

TEST(Ros2Slave, NamesAPublisherOfAnotherTypeWhileItWaits) {
    setenv("ROS_DOMAIN_ID", std::to_string(own_domain()).c_str(), 1);
    const Folder folder;
    const PortBlock ports;
    FastDdsPeer peer;
    peer.writer<HeardPose>(kForce);
    Child slave(built_programs() / "thimble-ros2-slave",
                {folder.write("session.toml", with_robot().text()).string(), "--base-port",
                 std::to_string(ports.base())},
                folder / "words");
    unsetenv("ROS_DOMAIN_ID");
    EXPECT_TRUE(wait_until([&] {
        return read_text(folder / "words")
                   .find(
                       "measured_cf has type geometry_msgs/msg/PoseStamped, not geometry_msgs/"
                       "msg/WrenchStamped") != std::string::npos;
    })) << read_text(folder / "words");
    slave.signal(SIGTERM);
    EXPECT_TRUE(wait_until([&] { return slave.poll().has_value(); }));
    EXPECT_EQ(slave.poll(), 1);
}

TEST(Ros2Slave, SaysWhichProgramWhichClockAndWhichInterface) {
    const Folder folder;
    const auto session = folder.write("session.toml", with_robot().text()).string();
    const auto other = folder.write("other.toml", SessionFile{}.text()).string();
    const auto far =
        folder.write("far.toml", with_robot("[slave_sim.ros2]\ninterface = '192.0.2.1'\n").text()).string();
    const auto waves =
        folder.write("waves.toml", with_robot("[control]\ncompensator = 'wave'\n").text()).string();
    const auto codec =
        folder.write("codec.toml", with_robot("[codec]\ncommand = 'every-nth'\n").text()).string();
    const auto expect_refusal = [](const char* program, const std::vector<std::string>& words,
                                   const char* says) {
        const auto refused = run_to_end(built_programs() / program, words);
        EXPECT_EQ(refused.code, 2) << refused.words;
        EXPECT_THAT(refused.words, HasSubstr(says));
    };
    expect_refusal("thimble-slave-sim", {session}, "needs thimble-ros2-slave");
    expect_refusal("thimble-ros2-slave", {other}, "use thimble-slave-sim");
    expect_refusal("thimble-ros2-slave", {far}, "'192.0.2.1' is not this machine alone");
    expect_refusal("thimble-ros2-slave", {waves}, "has an end at the slave");
    expect_refusal("thimble-ros2-slave", {codec}, "a robot needs every command");
    expect_refusal("thimble", {"study", session}, "works in real time only");
    expect_refusal("thimble", {"play", session}, "has a simulated needle");
    for (const char* clock : {"virtual", "lock-step"})
        expect_refusal("thimble", {"run", session, "--clock", clock}, "works in real time only");
    expect_refusal("thimble", {"run", session, "--print", "systemd"}, "no unit for thimble-ros2-slave");
}

}  // namespace
}  // namespace thimble
