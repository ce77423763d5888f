// Words, reports and exit codes of thimble-netem.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/loopback/relay/relay_rig.hpp"

namespace thimble {
namespace {

using nlohmann::json;
using testing::HasSubstr;

TEST_F(RelayProgram, SaysThatNobodyListens) {
    const PortBlock nobodys;
    const std::string address = "127.0.0.1:" + std::to_string(nobodys.base());
    NetemProgram netem({"--listen", "127.0.0.1:0", "--to", address});
    const Client client(netem.inlet());
    client.say("x");
    EXPECT_TRUE(wait_until(
        [&] { return netem.said().find("nobody listens at UDP " + address) != std::string::npos; }));
}

// They are the way up, and packets overtake each other under jitter.
TEST_F(RelayProgram, SaysWhatTcsWordsMean) {
    NetemProgram netem(
        in_front({"--profile", "sudo tc qdisc add dev eth0 root netem delay 30ms 5ms", "--json"}));
    const Client client(netem.inlet());
    ASSERT_TRUE(client.round_trip("x"));
    netem.signal(SIGINT);
    ASSERT_EQ(netem.wait(), 0);
    EXPECT_THAT(netem.said(), HasSubstr("the way up only"));
    EXPECT_THAT(netem.said(), HasSubstr("up: packets overtake each other"));
    const json summary = json::parse(netem.printed());
    EXPECT_GE(summary.at("up").at("delay").at("achieved_mean_s").get<double>(), 0.025);
    EXPECT_EQ(summary.at("down").at("asked").at("delay_s"), 0.0);
    const Ended printed = run_netem({"--profile", "delay 30ms", "--print-tc", "eth1,eth0"});
    EXPECT_THAT(printed.printed, HasSubstr("towards the server\ntc qdisc add dev eth1 root netem"));
    EXPECT_THAT(printed.printed, HasSubstr("towards the clients\n# no netem is needed"));
    const std::string changing =
        folder_.write("p.toml", "[[change]]\nat_s = 5\ndirection = 'up'\nloss = 1\n");
    EXPECT_THAT(run_netem({"--profile", changing, "--print-tc", "eth1,eth0"}).printed,
                HasSubstr("towards the server\n# differs: 1 changes with time; tc would need a script\n"));
}

TEST_F(RelayProgram, AsksForWhatItsTraceHas) {
    const std::string trace =
        folder_.write("path.csv", "time_s,delay_s,loss\n0,0.01,0\n1,0.03,0.5\n").string();
    const Ended end = run_netem(
        in_front({"--link", "up.trace=" + trace, "up.delay_s=0.2", "loss=1", "--seconds", "0.1", "--json"}));
    ASSERT_EQ(end.code, 0) << end.said;
    EXPECT_THAT(end.said, HasSubstr("20 ms up, 0 ms down"));
    const json up = json::parse(end.printed).at("up"), &asked = up.at("asked");
    EXPECT_EQ(asked.at("delay_s"), 0.02);
    EXPECT_EQ(asked.at("loss"), 0.25);
    EXPECT_EQ(up.at("delay").at("asked_mean_s"), 0.02);
    EXPECT_EQ(up.at("loss").at("asked"), 0.25);
}

TEST_F(RelayProgram, RefusesAPortThatIsTaken) {
    NetemProgram first(in_front());
    const Ended second = run_netem({"--listen", to_string(first.inlet()), "--to", echo_.address()});
    EXPECT_EQ(second.code, 3);
    EXPECT_THAT(second.said, HasSubstr(to_string(first.inlet())));
}

TEST_F(RelayProgram, RefusesAControlPathThatIsInUse) {
    const std::string control = folder_ / "control";
    NetemProgram first(in_front({"--control", control}));
    first.inlet();
    EXPECT_EQ(run_netem(in_front({"--control", control})).code, 3);
    first.signal(SIGKILL);
    first.wait();
    NetemProgram heir(in_front({"--control", control}));
    heir.inlet();
    EXPECT_EQ(run_netem({"show", "--control", control}).code, 0) << "what a dead program left is replaced";
}

TEST_F(RelayProgram, SaysWhatIsWrongWithACommandLine) {
    EXPECT_EQ(run_netem({"--listen", "9000"}).code, 2);
    EXPECT_EQ(run_netem({"--listen", "x", "--to", "127.0.0.1:1"}).code, 2);
    EXPECT_EQ(run_netem({"--listen", "0", "--to", "127.0.0.1:1", "--link", "loss=2"}).code, 2);
    EXPECT_EQ(run_netem({"--listen", "0", "--to", "127.0.0.1:1", "--nonsense"}).code, 2);
    for (const char* of_traffic : {"--strict-rt", "--log=x", "--metrics=1", "--idle-s=1", "--print-tc=eth0"})
        EXPECT_EQ(run_netem({"--selftest", of_traffic}).code, 2) << of_traffic;
    EXPECT_EQ(run_netem({"log", "/nowhere"}).code, 5);
    EXPECT_THAT(run_netem({"log", "/proc/self/mem"}).said, HasSubstr("cannot be read to its end"));
    const Ended help = run_netem({"--help"});
    EXPECT_EQ(help.code, 0);
    EXPECT_THAT(help.printed, HasSubstr("thimble-netem --listen 9000"));
    EXPECT_THAT(run_netem({"node", "--help"}).printed, HasSubstr("--base-port"));
    for (const char* of_relay : {"--profile=lte", "--max-flows=2", "--metrics=9464"})
        EXPECT_THAT(run_netem({of_relay}).said, HasSubstr("--listen")) << of_relay;
}

TEST_F(RelayProgram, KeepsASettingThroughTheChangesOfAProfile) {
    const auto profile = folder_.write(
        "changes.toml", "[up]\ndelay_s = 0.01\n[down]\ndelay_s = 0.01\n[[change]]\nat_s = 0\nloss = 0.5\n");
    const std::string control = folder_ / "control";
    NetemProgram netem(
        in_front({"--profile", profile.string(), "--link", "delay_s=0.2", "--control", control}));
    netem.inlet();
    const json shown = json::parse(run_netem({"show", "--control", control, "--json"}).printed);
    for (const char* way : {"up", "down"}) {
        EXPECT_EQ(shown.at(way).at("asked").at("delay_s"), 0.2) << shown;
        EXPECT_EQ(shown.at(way).at("asked").at("loss"), 0.5) << shown;
    }
}

TEST_F(RelayProgram, ReportsThoughItsLogHasNoRoom) {
    const Ended end = run_netem(in_front({"--log", "/dev/full", "--seconds", "0.2"}));
    EXPECT_EQ(end.code, 5);
    EXPECT_THAT(end.said, HasSubstr("is incomplete"));
    EXPECT_THAT(end.printed, HasSubstr("0 flows"));
}

TEST_F(RelayProgram, SaysThatItHasNoWayToTheServer) {
    NetemProgram netem({"--listen", "127.0.0.1:0", "--to", "255.255.255.255:9"});
    Client(netem.inlet()).say("hello");
    EXPECT_TRUE(wait_until(
        [&] { return netem.said().find("255.255.255.255:9") != netem.said().rfind("255.255.255.255:9"); }));
    netem.signal(SIGINT);
    EXPECT_EQ(netem.wait(), 0);
    EXPECT_THAT(netem.printed(), testing::Not(HasSubstr("--max-flows")));
}

TEST_F(RelayProgram, TestsItself) {
    const Ended test = run_netem({"--selftest", "--seconds", "2", "--json", "--link", "delay_s=0.02",
                                  "loss=0.02", "jitter=uniform", "jitter_spread_s=0.005"});
    ASSERT_TRUE(test.code == 0 || test.code == 1) << test.said;
    const json result = json::parse(test.printed);
    EXPECT_EQ(result.at("verdict") == "FAIL", test.code == 1);
    EXPECT_EQ(result.at("verdict") == "PASS", result.at("causes").empty());
    for (const char* direction : {"up", "down"}) {
        EXPECT_EQ(result.at(direction).at("early"), 0) << direction;
        EXPECT_EQ(result.at(direction).at("other_fates"), 0) << direction;
        EXPECT_GT(result.at(direction).at("received"), 100) << direction;
        EXPECT_GT(result.at(direction).at("dropped_as_asked"), 0) << direction;
    }
    EXPECT_GT(result.at("bare_timer").at("count"), 10);
}

TEST_F(RelayProgram, AnInterruptedSelftestGivesNoVerdict) {
    NetemProgram test({"--selftest", "--seconds", "5", "--link", "delay_s=6s"});
    EXPECT_TRUE(wait_until([&] { return test.said().find("the test ends") != std::string::npos; }));
    test.signal(SIGINT);
    EXPECT_EQ(test.wait(), 1);
    EXPECT_THAT(test.said(), HasSubstr("interrupted"));
    EXPECT_EQ(test.printed(), "");
}

}  // namespace
}  // namespace thimble
