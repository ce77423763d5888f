// Logs as ROS 2 messages, read by programs that are not Thimble's.
#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "tests/read_text.hpp"
#include "tests/refusal.hpp"
#include "tests/unit/log/written_log.hpp"
#include "thimble/log/log_export.hpp"
#include "thimble/log/log_tools.hpp"
#include "thimble/log/ros2_messages.hpp"

namespace thimble {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

// A master on a machine whose clock is one second ahead, its session, and slave_sim, each with a log.
class Ros2Logs : public testing::Test {
  protected:
    Ros2Logs() {
        ForceFeedback record;
        record.position_needle_m = 0.06;
        record.position_surface_m = 0.021;
        record.velocity_surface_m_per_s = -0.5;
        record.position_proxy_m = 0.05;
        record.force_tissue_N = -1.25;
        record.force_fixture_N = -2;
        record.force_total_N = -3.25;
        add("session", {.program = "session",
                        .direction = "received",
                        .topic = "/slave_sim/record",
                        .realtime_ns = "1700000000000000000",
                        .messages = {{1, 2'000'000'020}},
                        .more = [](McapWriter& writer) { say_master_is_ahead(writer, "1.0"); },
                        .bodies = {Message{{7, {}, 0, 3, Role::kSlaveSim}, record}}});
        NeedleCommand command;
        command.position_needle_m = 0.06;
        command.velocity_needle_m_per_s = 0.3;
        command.position_hand_m = 0.02;
        command.velocity_hand_m_per_s = 0.1;
        command.force_hand_N = 0.75;  // pushes the hand out
        add("master", {.boot = "another machine",
                       .realtime_ns = "1234",  // its date is wrong, too
                       .messages = {{1, 3'000'000'010}},
                       .bodies = {Message{{8, {}, 0, 3, Role::kMaster}, command}}});
    }
    void add(const std::string& name, const WrittenLog& log) {
        log.write(folder_ / (name + ".mcap"));
        files_.push_back(std::make_unique<LoggedFile>(folder_ / (name + ".mcap")));
    }
    void add_orders(const SessionControl& order) {
        add("orders", {.program = "session",
                       .topic = "/session/orders/master",
                       .messages = {{1, 5}},
                       .bodies = {2, Message{{7, {}, 0, 4, Role::kSession}, order}}});
    }
    // Messages to master and fingertip, the finger's percept, and an order.
    void add_arrivals() {
        ForceFeedback force;
        force.force_total_N = -4.5;
        Percept percept;
        percept.force_N = 1.5;
        const auto add_one = [&](const std::string& name, const std::string& topic,
                                 const decltype(Message::body)& body) {
            add(name, {.direction = "received",
                       .topic = topic,
                       .messages = {{1, 2'000'000'040}},
                       .bodies = {Message{{7, {}, 0, 3, Role::kSlaveSim}, body}}});
        };
        add_one("at_master", "/slave_sim/force_feedback/master", force);
        add_one("at_finger", "/slave_sim/force_feedback/cutaneous", force);
        add_one("felt", "/cutaneous/percept", percept);
        SessionControl start;
        start.modality = Modality::kCF;
        add_one("order", "/session/orders/master", start);
    }
    TemporaryDirectory folder_;
    std::vector<std::unique_ptr<LoggedFile>> files_;
};

TEST_F(Ros2Logs, ReadByOthers) {
    const std::filesystem::path modules = THIMBLE_SOURCE_DIR "/build/log_reader/node_modules";
    if (!std::filesystem::exists(modules / "@foxglove/rosmsg2-serialization"))
        GTEST_SKIP() << "readers of ROS 2 messages are not installed: deploy/install-log-reader does that "
                        "where there is npm";
    add_arrivals();
    EXPECT_EQ(export_ros2(files_, folder_ / "ros2.mcap", "").topics, 17U);
    std::filesystem::copy_file(THIMBLE_SOURCE_DIR "/tests/log_reader/read_ros2.mjs",
                               folder_ / "read_ros2.mjs");
    std::filesystem::create_directory_symlink(modules, folder_ / "node_modules");
    const auto said = folder_ / "said";
    const std::string command =
        "cd '" + folder_.path().string() + "' && node read_ros2.mjs ros2.mcap > said 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0) << read_text(said);
    const auto found = nlohmann::json::parse(read_text(said));
    EXPECT_EQ(found["profile"], "ros2");

    const auto of = [&](const char* topic, const char* type) {
        const auto& its = found["topics"][topic];
        EXPECT_EQ(its["type"], type) << topic;
        EXPECT_EQ(its["messages"].size(), 1U) << topic;
        return its["messages"][0]["value"];
    };
    // Each z, after all the rest has been found to be 0, and the frame to be that one.
    const auto along_z = [](double z) { return nlohmann::json{{"x", 0}, {"y", 0}, {"z", z}}; };
    const auto frame_of = [](const std::string& topic) {
        if (topic == "/cutaneous/measured_cf") return "finger";
        return topic.starts_with("/master/measured") ? "handle" : "tissue";
    };
    const auto z_of = [&](const char* topic, const char* type, const char* name, const char* first,
                          const char* second, const nlohmann::json& its_second) {
        auto value = of(topic, type);
        EXPECT_EQ(value["header"]["frame_id"], frame_of(topic)) << topic;
        const double z = value[name][first]["z"];
        value.erase("header");
        EXPECT_EQ(value, (nlohmann::json{{name, {{first, along_z(z)}, {second, its_second}}}})) << topic;
        return z;
    };
    const auto pose_z = [&](const char* topic) {
        nlohmann::json none = along_z(0);
        none["w"] = 1;
        return z_of(topic, "geometry_msgs/msg/PoseStamped", "pose", "position", "orientation", none);
    };
    const auto twist_z = [&](const char* topic) {
        return z_of(topic, "geometry_msgs/msg/TwistStamped", "twist", "linear", "angular", along_z(0));
    };
    const auto force_z = [&](const char* topic) {
        return z_of(topic, "geometry_msgs/msg/WrenchStamped", "wrench", "force", "torque", along_z(0));
    };
    EXPECT_EQ(pose_z("/master/measured_cp"), 0.02);
    EXPECT_EQ(twist_z("/master/measured_cv"), 0.1);
    EXPECT_EQ(force_z("/master/measured_cf"), -0.75);
    EXPECT_EQ(pose_z("/slave_sim/servo_cp"), 0.06);
    EXPECT_EQ(twist_z("/slave_sim/servo_cv"), 0.3);
    EXPECT_EQ(pose_z("/slave_sim/measured_cp"), 0.06);
    EXPECT_EQ(force_z("/slave_sim/measured_cf"), -3.25);
    EXPECT_EQ(force_z("/slave_sim/tissue/measured_cf"), -1.25);
    EXPECT_EQ(force_z("/slave_sim/fixture/measured_cf"), -2);
    EXPECT_EQ(pose_z("/slave_sim/surface/measured_cp"), 0.021);
    EXPECT_EQ(twist_z("/slave_sim/surface/measured_cv"), -0.5);
    EXPECT_EQ(pose_z("/slave_sim/proxy/measured_cp"), 0.05);
    EXPECT_EQ(force_z("/master/servo_cf"), -4.5);
    EXPECT_EQ(force_z("/cutaneous/servo_cf"), -4.5);
    EXPECT_EQ(force_z("/cutaneous/measured_cf"), 1.5);
    EXPECT_EQ(of("/session/event", "std_msgs/msg/String"),
              nlohmann::json::parse(R"({"data": "trial start 3 CF"})"));

    // Of odd lengths, so that what follows has to be aligned.
    const auto joint = of("/master/measured_js", "sensor_msgs/msg/JointState");
    EXPECT_EQ(joint["name"], nlohmann::json::array({"insertion"}));
    EXPECT_EQ(joint["position"], nlohmann::json::array({0.02}));
    EXPECT_EQ(joint["velocity"], nlohmann::json::array({0.1}));
    EXPECT_EQ(joint["effort"], nlohmann::json::array({-0.75}));

    // Both on the session's clock: 10 ns apart, although the master's is a second ahead and its date is 1970's.
    const auto stamp = [&](const char* topic) {
        return found["topics"][topic]["messages"][0]["value"]["header"]["stamp"];
    };
    EXPECT_EQ(stamp("/master/measured_cp"), nlohmann::json::parse(R"({"sec": 1700000002, "nanosec": 10})"));
    EXPECT_EQ(stamp("/slave_sim/measured_cp"),
              nlohmann::json::parse(R"({"sec": 1700000002, "nanosec": 20})"));
    EXPECT_EQ(found["topics"]["/master/measured_cp"]["messages"][0]["log_time_ns"], "1700000002000000010");
    EXPECT_EQ(joint["header"]["frame_id"], "handle");
}

// Of two copies of a message one is exported; orders that are said again are one event; what arrives is what arrived.
TEST_F(Ros2Logs, EachThingOnce) {
    add("slave", {.program = "thimble-slave-sim", .direction = "received", .messages = {{1, 15}}});
    SessionControl start;
    start.modality = Modality::kCF;
    add_orders(start);
    for (const char* direction : {"sent", "received"}) {
        add(direction, {.direction = direction,
                        .topic = "/slave_sim/force_feedback/master",
                        .messages = {{1, 30}},
                        .bodies = {Message{{7, {}, 0, 4, Role::kSlaveSim}, ForceFeedback{}}}});
    }
    EXPECT_EQ(export_ros2(files_, folder_ / "ros2.mcap", "").topics, 15U);
    const LoggedFile written(folder_ / "ros2.mcap");
    EXPECT_EQ(written.scan().messages, 15U);
    EXPECT_TRUE(written.scan().finished);
    EXPECT_THAT(describe_log(written), AllOf(HasSubstr("  written by  thimble "), HasSubstr("    topic"),
                                             Not(HasSubstr("begun")), Not(HasSubstr("received"))));
    EXPECT_THROW(export_ros2(files_, folder_ / "ros2.mcap", ""), Error);
}

// The session says a network to each node again and again. One of these orders has been overtaken on its way.
TEST_F(Ros2Logs, EveryChangeOfTheNetworkWithItsValue) {
    files_.clear();
    WrittenLog orders;
    orders.direction = "received";
    orders.topic = "/session/orders/master";
    orders.body_by_body = true;
    orders.bodies.clear();
    const auto say = [&](std::uint32_t sequence, std::uint32_t trial, const char* name, double delay_s) {
        SessionControl change;
        change.kind = ControlKind::kNetworkChange;
        change.network = *NetworkName::of(name);
        change.network_delay_s = delay_s;
        orders.bodies.push_back(Message{{7, {}, 0, trial, Role::kSession}, change});
        orders.messages.push_back({sequence, static_cast<std::int64_t>(10 * orders.bodies.size())});
    };
    say(1, 4, "", 0.05);
    say(2, 4, "", 0.05);
    say(4, 4, "lte", 0.0205);
    say(3, 4, "", 0.05);
    say(5, 4, "lte", 0.1);
    say(6, 4, "", 0.05);
    say(7, 5, "", 0.05);
    say(8, 5, "", 0.05);
    add("orders", orders);
    export_ros2(files_, folder_ / "ros2.mcap", "");
    std::vector<std::string> events;
    LoggedFile(folder_ / "ros2.mcap").for_each([&](const LoggedTopic&, const McapMessage& m) {
        events.emplace_back(m.data.begin() + 8, m.data.end() - 1);  // behind CDR's head and the length
    });
    EXPECT_THAT(events, ElementsAre("network change 4 0.05 s", "network change 4 lte 0.0205 s",
                                    "network change 4 lte 0.1 s", "network change 4 0.05 s",
                                    "network change 5 0.05 s"));
}

TEST_F(Ros2Logs, OnlyTheTopicsAskedFor) {
    EXPECT_EQ(export_ros2(files_, folder_ / "ros2.mcap", "/slave_sim").topics, 7U);
}

// With only orders recorded, or a log forgotten, the message names the missing data and the log that has them.
TEST_F(Ros2Logs, WhatIsMissingIsNamed) {
    const Ros2Written two = export_ros2(files_, folder_ / "two.mcap", "");
    EXPECT_THAT(two.missing, ElementsAre(HasSubstr("/master/servo_cf"), HasSubstr("/cutaneous/servo_cf"),
                                         HasSubstr("/cutaneous/measured_cf")));
    EXPECT_FALSE(two.events_only);
    EXPECT_THAT(export_ros2(files_, folder_ / "part.mcap", "/master").missing, IsEmpty());

    files_.clear();
    add_orders({});
    const Ros2Written events = export_ros2(files_, folder_ / "events.mcap", "");
    EXPECT_EQ(events.topics, 1U);
    EXPECT_EQ(events.missing.size(), 5U);
    EXPECT_TRUE(events.events_only);
}

TEST(Cdr, NumbersStandAtMultiplesOfTheirSize) {
    CdrOutput out;
    Ros2Value value;
    value.frame = "ab";
    value.z = 1;
    const Bytes bytes = ros2_bytes(Ros2Type::kWrenchStamped, value, out);
    EXPECT_EQ(bytes.size(), 4U + 16 + 48);  // 8 of stamp, 4 + 3 of the frame, filled up to 16
    EXPECT_EQ(bytes[1], 1);                 // little-endian
}

}  // namespace
}  // namespace thimble
