// thimble-ros2, heard through another DDS (fast_dds_peer.hpp).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/flow.hpp"
#include "common/runtime/sockets.hpp"
#include "common/runtime/wall_clock.hpp"
#include "tests/loopback/observe/fast_dds_peer.hpp"
#include "tests/loopback/real_run.hpp"

namespace thimble {
namespace {

using testing::Contains;
using testing::HasSubstr;

class Ros2Program {
  public:
    Ros2Program(const std::string& config, std::uint16_t base_port)
        : child_(built_programs() / "thimble-ros2",
                 words_in(config, {"--base-port", std::to_string(base_port), "--domain",
                                   std::to_string(own_domain())}),
                 folder_ / "words") {}

    std::string words() const { return read_text(folder_ / "words"); }
    int end() {
        child_.signal(SIGTERM);
        return child_.wait(kPatience).value_or(-1);
    }

  private:
    Folder folder_;
    Child child_;
};

// A session's side of the monitor alone, without protection.
struct SpokenMonitor {
    explicit SpokenMonitor(std::uint16_t base_port)
        : sockets(network_at(base_port)),
          flow(Role::kSession, 7, {sockets.between(Port::kSessionOrders, Port::kExperimenterMonitor)}) {}
    void say(std::uint32_t trial) { flow.send(wall_now(), trial, monitor); }

    Monitor monitor;
    Sockets sockets;
    OutboundFlow flow;
};

// The newest message, once there is one, while the monitor goes on.
template <class Type>
typename Type::type heard(dds::DataReader* reader, SpokenMonitor& session) {
    std::optional<typename Type::type> message;
    EXPECT_TRUE(wait_until([&] {
        session.say(3);
        return (message = take<Type>(reader)).has_value();
    }));
    return message.value_or(typename Type::type{});
}

std::vector<std::string> texts(dds::DataReader* reader) {
    std::vector<std::string> all;
    while (const auto text = take<HeardString>(reader)) all.push_back(text->data());
    return all;
}

TEST(Ros2, AnotherDdsHearsEachNumber) {
    const Folder folder;
    const PortBlock ports;
    Ros2Program program(folder.write("session.toml", kUnprotectedTable).string(), ports.base());
    SpokenMonitor session(ports.base());
    Monitor& m = session.monitor;
    m.state = NodeState::kRunning;
    m.modality = Modality::kCF;
    m.fixture_present = true;
    m.beeped = true;
    m.position_needle_m = 0.125;
    m.position_surface_m = 0.02;
    m.position_fixture_m = 0.1;
    m.force_total_N = -3.25;
    m.force_tissue_N = -1.25;
    m.force_fixture_N = -2;
    m.force_hand_N = 1.5;

    FastDdsPeer peer;
    const std::string slave = "/thimble/slave_sim/";
    auto* const needle = peer.reader<HeardPose>(slave + "measured_cp");
    auto* const surface = peer.reader<HeardPose>(slave + "surface/measured_cp");
    auto* const total = peer.reader<HeardWrench>(slave + "measured_cf");
    auto* const tissue = peer.reader<HeardWrench>(slave + "tissue/measured_cf");
    auto* const fixture = peer.reader<HeardWrench>(slave + "fixture/measured_cf");
    auto* const hand = peer.reader<HeardWrench>("/thimble/master/measured_cf");
    auto* const tf = peer.reader<HeardTransforms>("/tf", Asks::kTransforms);
    auto* const clock = peer.reader<HeardClock>("/clock");

    const auto pose = heard<HeardPose>(needle, session);
    EXPECT_EQ(pose.header().frame_id(), "tissue");
    EXPECT_EQ(pose.pose().position().z(), 0.125);
    EXPECT_EQ(pose.pose().orientation().w(), 1);
    EXPECT_EQ(heard<HeardPose>(surface, session).pose().position().z(), 0.02);
    EXPECT_EQ(heard<HeardWrench>(total, session).wrench().force().z(), -3.25);
    EXPECT_EQ(heard<HeardWrench>(tissue, session).wrench().force().z(), -1.25);
    EXPECT_EQ(heard<HeardWrench>(fixture, session).wrench().force().z(), -2);
    const auto force = heard<HeardWrench>(hand, session);
    EXPECT_EQ(force.header().frame_id(), "handle");
    EXPECT_EQ(force.wrench().force().z(), -1.5);
    const auto frames = heard<HeardTransforms>(tf, session).transforms();
    ASSERT_EQ(frames.size(), 3U);
    EXPECT_EQ(frames[2].child_frame_id(), "fixture");
    EXPECT_EQ(frames[2].transform().translation().z(), 0.1);
    EXPECT_NEAR(static_cast<double>(heard<HeardClock>(clock, session).clock().sec()),
                static_cast<double>(std::time(nullptr)), 60);

    // These came before their readers.
    auto* const events = peer.reader<HeardString>("/thimble/session/event", Asks::kLatched);
    auto* const state = peer.reader<HeardString>("/thimble/session/state", Asks::kLatched);
    auto* const tf_static = peer.reader<HeardTransforms>("/tf_static", Asks::kLatched);
    EXPECT_EQ(heard<HeardString>(events, session).data(), "trial start 3 CF");
    EXPECT_EQ(heard<HeardString>(events, session).data(), "beep 3");
    EXPECT_TRUE(
        wait_until([&] { return heard<HeardString>(state, session).data() == "running trial 3 CF free"; }));
    EXPECT_EQ(heard<HeardTransforms>(tf_static, session).transforms().size(), 3U);
    EXPECT_TRUE(wait_until([&] {
        const auto said = take<HeardString>(state);
        return said && said->data() == "no session";
    })) << "after the last Monitor";
    EXPECT_EQ(program.end(), 0) << program.words();
}

// The other DDS hears that the needle moves, that the trial has begun, and that the session is over.
void expect_heard(const SessionFile& session, const std::vector<std::string>& clock) {
    const Folder folder;
    const auto config = folder.write("session.toml", session.text()).string();
    FastDdsPeer peer;
    auto* const needle = peer.reader<HeardPose>("/thimble/slave_sim/measured_cp");
    auto* const events = peer.reader<HeardString>("/thimble/session/event", Asks::kLatched);
    auto* const state = peer.reader<HeardString>("/thimble/session/state", Asks::kLatched);
    RealRun run(session, clock);
    Ros2Program program(config, run.base_port());
    double deepest_m = 0;
    EXPECT_TRUE(wait_until([&] {
        while (const auto pose = take<HeardPose>(needle))
            deepest_m = std::max(deepest_m, pose->pose().position().z());
        return deepest_m > 0.02;
    })) << run.words()
        << program.words();
    std::vector<std::string> told;
    wait_until([&] { return !(told = texts(events)).empty(); });
    EXPECT_THAT(told, Contains("trial start 1 HF"));
    run.launcher().signal(SIGTERM);
    run.end();
    std::vector<std::string> states;
    EXPECT_TRUE(wait_until([&] {
        for (const std::string& text : texts(state)) states.push_back(text);
        return !states.empty() && states.back() == "no session";
    }));
    EXPECT_THAT(states, Contains(HasSubstr("running trial 1 HF")));
    EXPECT_EQ(program.end(), 0) << program.words();
}

// Under a lab key, which the observer reads too.
TEST(Ros2, AnotherDdsHearsARunningSession) {
    const Folder folder;
    SessionFile session = SessionFile::endless();
    session.more = under_lab_key(folder / "lab.key");
    expect_heard(session, {"--monitor"});
}

TEST(Ros2, AnotherDdsHearsASessionInLockStep) {
    SessionFile session = SessionFile::endless(kEndlessInLockStep_s);
    session.more = kUnprotectedTable;
    expect_heard(session, {"--monitor", "--clock", "lock-step"});
}

TEST(Ros2, HelpNamesTopicsAndTypesEvenWithABadDomain) {
    setenv("ROS_DOMAIN_ID", "kitchen", 1);
    const Outcome help = run_to_end(built_programs() / "thimble-ros2", {"--help"});
    const Outcome refused = run_to_end(built_programs() / "thimble-ros2", {});
    unsetenv("ROS_DOMAIN_ID");
    EXPECT_EQ(refused.code, 2);
    EXPECT_THAT(refused.words, HasSubstr("ROS_DOMAIN_ID is 'kitchen'"));
    EXPECT_EQ(help.code, 0);
    for (const char* said : {"/thimble/slave_sim/measured_cf", "geometry_msgs/msg/WrenchStamped", "/clock",
                             "/tf_static", "/thimble/slave/servo_cp", "/thimble/handle/servo_cf"})
        EXPECT_THAT(help.words, HasSubstr(said));
}

TEST(Ros2, AnotherMachineIsRefusedByName) {
    const auto refused = run_to_end(built_programs() / "thimble-ros2", {"--interface", "192.0.2.1"});
    EXPECT_EQ(refused.code, 2);
    EXPECT_THAT(refused.words, HasSubstr("--interface: '192.0.2.1' is not this machine alone"));
    for (const char* prefix : {"a b", "lab", "/", "/lab/", "/lab//thimble", "/lab/2"})
        EXPECT_EQ(run_to_end(built_programs() / "thimble-ros2", {"--prefix", prefix}).code, 2) << prefix;
}

}  // namespace
}  // namespace thimble
