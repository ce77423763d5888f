// thimble-netem in front of an echo server. Clocks are asked for order and wide bounds only.
#include <sys/stat.h>
#include <sys/un.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "netem/relay/packet_record.hpp"
#include "netem/relay/relay_report.hpp"
#include "netem/relay/request_server.hpp"
#include "tests/loopback/relay/relay_rig.hpp"

namespace thimble {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using testing::HasSubstr;

TEST_F(RelayProgram, CtrlCPrintsTheSummaryAndKeepsTheLog) {
    const std::string log = folder_ / "packets.bin";
    NetemProgram netem(
        in_front({"--precise", "--json", "--log", log, "--link", "up.delay_s=0.02", "down.delay_s=0.005"}));
    const Client client(netem.inlet());
    for (int i = 0; i < 10; ++i) ASSERT_TRUE(client.round_trip("x"));
    netem.signal(SIGINT);
    ASSERT_EQ(netem.wait(), 0) << netem.said();
    const json summary = json::parse(netem.printed());
    EXPECT_EQ(summary.at("up").at("packets").at("sent"), 10);
    EXPECT_EQ(summary.at("down").at("packets").at("sent"), 10);
    EXPECT_GE(summary.at("up").at("delay").at("achieved_least_s").get<double>(), 0.02);
    EXPECT_GE(summary.at("down").at("delay").at("achieved_least_s").get<double>(), 0.005);
    const Ended csv = run_netem({"log", log});
    EXPECT_EQ(csv.code, 0) << csv.said;
    EXPECT_THAT(csv.printed, HasSubstr(std::string(record_csv_header())));
    EXPECT_EQ(std::count(csv.printed.begin(), csv.printed.end(), '\n'), 21);
    EXPECT_THAT(csv.printed, HasSubstr("0,0,down,9,1,sent"));
}

TEST_F(RelayProgram, LosesAsItsSeedSays) {
    std::string logs[2];
    for (std::string& text : logs) {
        const std::string log = folder_ / "packets.csv";
        const std::string control = folder_ / "control";
        NetemProgram netem(
            in_front({"--seed", "5", "--log", log, "--control", control, "--link", "up.loss=0.4"}));
        const Client client(netem.inlet());
        for (int i = 0; i < 200; ++i) client.say("x");
        EXPECT_TRUE(wait_until([&] {
            const json shown = json::parse(run_netem({"show", "--control", control, "--json"}).printed);
            return shown.at("up").at("packets").at("received") == 200;
        }));
        netem.signal(SIGTERM);
        ASSERT_EQ(netem.wait(), 0);
        const std::string all = read_text(log);
        for (std::size_t at = 0; at < all.size();) {
            const std::size_t end = all.find('\n', at);
            const std::string line = all.substr(at, end - at);
            if (line.find(",lost,") != std::string::npos) text += line.substr(0, line.find(",lost,")) + "\n";
            at = end + 1;
        }
    }
    EXPECT_THAT(logs[0], HasSubstr("0,0,up,"));
    EXPECT_EQ(logs[0], logs[1]);
}

TEST_F(RelayProgram, ObeysItsControlSocket) {
    const std::string control = folder_ / "control";
    NetemProgram netem(in_front({"--control", control}));
    const Client client(netem.inlet());
    ASSERT_TRUE(client.round_trip("before"));
    struct stat found {};
    ASSERT_EQ(stat(control.c_str(), &found), 0);
    EXPECT_EQ(found.st_mode & 0777, 0600U);
    EXPECT_EQ(run_netem({"set", "--control", control, "up.delay_s=0.08"}).code, 0);
    const auto took = client.round_trip("after");
    ASSERT_TRUE(took);
    EXPECT_GE(*took, milliseconds{80});
    const Ended shown = run_netem({"show", "--control", control, "--json"});
    ASSERT_EQ(shown.code, 0) << shown.said;
    EXPECT_EQ(json::parse(shown.printed).at("up").at("asked").at("delay_s"), 0.08);
    EXPECT_EQ(json::parse(shown.printed).at("down").at("asked").at("delay_s"), 0.0);
    EXPECT_THAT(run_netem({"show", "--control", control}).printed, HasSubstr("asked 80 ms"));
    EXPECT_THAT(run_netem({"watch", "--control", control, "--lines", "1"}).printed, HasSubstr("1 flows"));
    const Ended refused = run_netem({"set", "--control", control, "loss=7"});
    EXPECT_EQ(refused.code, 2);
    EXPECT_THAT(refused.said, HasSubstr("loss"));
    netem.signal(SIGINT);
    EXPECT_EQ(netem.wait(), 0);
    EXPECT_NE(stat(control.c_str(), &found), 0) << "the socket is gone";
    EXPECT_EQ(run_netem({"show", "--control", control}).code, 3);
}

// Another relay may answer at the same path, with smaller counters.
TEST_F(RelayProgram, WatchesARelayThatStartsAgain) {
    const std::string control = folder_ / "control";
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    ASSERT_LT(control.size(), sizeof name.sun_path) << "set TMPDIR to a shorter path";
    control.copy(name.sun_path, sizeof name.sun_path - 1);
    const int listening = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    ASSERT_EQ(bind(listening, static_cast<sockaddr*>(static_cast<void*>(&name)), sizeof name), 0);
    ASSERT_EQ(listen(listening, 1), 0);
    RelayState state;
    state.totals.running = std::chrono::seconds{9};
    state.totals.direction[0].packets.pushed = 100;
    const RequestServer stand_in(listening, kPatience, 4096, [&](std::string_view) {
        nlohmann::ordered_json answer{{"ok", true}};
        answer.update(describe(state));
        state.totals.running = std::chrono::seconds{2};
        state.totals.direction[0].packets.pushed = 6;
        return answer.dump();
    });
    const Ended watch = run_netem({"watch", "--control", control, "--lines", "1"});
    EXPECT_THAT(watch.printed, HasSubstr("| up         3/s in"));
}

TEST_F(RelayProgram, OutlivesGarbageOnItsControlSocket) {
    const std::string control = folder_ / "control";
    NetemProgram netem(in_front({"--control", control}));
    const Client client(netem.inlet());
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    ASSERT_LT(control.size(), sizeof name.sun_path) << "set TMPDIR to a shorter path";
    control.copy(name.sun_path, sizeof name.sun_path - 1);
    netem.inlet();
    std::vector<int> raws;
    for (const std::string& words :
         {std::string("set\nloss=\xff\xfe"), std::string(60000, '['), std::string(1, '\0'),
          std::string("set\n" + std::string(9000, '.') + "=1"),
          std::string("set\nx=" + std::string(8000, '['))}) {
        raws.push_back(socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0));
        ASSERT_EQ(connect(raws.back(), static_cast<sockaddr*>(static_cast<void*>(&name)), sizeof name), 0);
        if (words[0] != '\0')
            ::send(raws.back(), words.data(), words.size(), MSG_NOSIGNAL);  // the other one is silent
    }
    const Ended refused = run_netem({"set", "--control", control, "loss=\xff\xfe"});
    EXPECT_EQ(refused.code, 2) << refused.said;
    EXPECT_TRUE(client.round_trip("still here"));
    EXPECT_EQ(run_netem({"show", "--control", control}).code, 0);
    for (const int raw : raws) close(raw);
}

// A path reaches across network namespaces; an abstract address does not.
TEST_F(RelayProgram, IsControlledFromAnotherNetworkNamespace) {
    const auto elsewhere = [&](std::vector<std::string> words) {
        words.insert(words.begin(), {"-rn", "--"});
        Child child("unshare", words, folder_ / "err");
        return child.wait(kPatience).value_or(-1);
    };
    if (elsewhere({"true"}) != 0)
        GTEST_SKIP() << "no user namespaces here: sysctl kernel.unprivileged_userns_clone=1";
    const std::string control = folder_ / "control",
                      program = std::filesystem::path(THIMBLE_BIN_DIR) / "thimble-netem";
    NetemProgram netem(in_front({"--control", control}));
    netem.inlet();
    EXPECT_EQ(elsewhere({program, "set", "--control", control, "up.delay_s=0.08"}), 0)
        << read_text(folder_ / "err");
    const Ended shown = run_netem({"show", "--control", control, "--json"});
    EXPECT_EQ(json::parse(shown.printed).at("up").at("asked").at("delay_s"), 0.08);
}

}  // namespace
}  // namespace thimble
