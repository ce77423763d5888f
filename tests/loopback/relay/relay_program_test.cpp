// thimble-netem in front of an echo server. Clocks are asked for order and wide bounds only.
#include "tests/loopback/relay/relay_program.hpp"

#include <csignal>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/runtime/wall_clock.hpp"
#include "netem/relay/packet_record.hpp"

namespace thimble {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using testing::HasSubstr;

class RelayProgram : public testing::Test {
  protected:
    std::vector<std::string> in_front(const std::vector<std::string>& more = {}) const {
        return words_in("--listen 127.0.0.1:0 --to " + echo_.address(), more);
    }
    EchoServer echo_;
    Folder folder_;
};

TEST_F(RelayProgram, TakesEachClientThereAndBack) {
    NetemProgram netem(in_front());
    const Client a(netem.inlet()), b(netem.inlet());
    a.say("a");
    b.say("b");
    EXPECT_EQ(a.hear(), "a");
    EXPECT_EQ(b.hear(), "b");
}

TEST_F(RelayProgram, DelaysBothWaysAndNothingLeavesEarly) {
    NetemProgram netem(in_front({"--precise", "--link", "up.delay_s=0.06", "down.delay_s=0.01"}));
    const Client client(netem.inlet());
    for (int i = 0; i < 5; ++i) {
        const auto took = client.round_trip("x" + std::to_string(i));
        ASSERT_TRUE(took);
        EXPECT_GE(*took, milliseconds{70});
    }
}

TEST_F(RelayProgram, CtrlCPrintsTheSummaryAndKeepsTheLog) {
    const std::string log = folder_ / "packets.bin";
    NetemProgram netem(in_front({"--json", "--log", log, "--link", "up.delay_s=0.02", "down.delay_s=0.005"}));
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
        NetemProgram netem(in_front({"--seed", "5", "--log", log, "--link", "up.loss=0.4"}));
        const Client client(netem.inlet());
        for (int i = 0; i < 200; ++i) client.say("x");
        for (int heard = 0; heard < 60 && client.hear(milliseconds{500}); ++heard) {
        }
        while (client.hear(milliseconds{200})) {
        }
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

TEST_F(RelayProgram, OutlivesGarbageOnItsControlSocket) {
    const std::string control = folder_ / "control";
    NetemProgram netem(in_front({"--control", control}));
    const Client client(netem.inlet());
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    control.copy(name.sun_path, sizeof name.sun_path - 1);
    const int raw = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    for (const std::string& words :
         {std::string("set\nloss=\xff\xfe"), std::string(60000, '['), std::string(1, '\0'),
          std::string("set\n" + std::string(9000, '.') + "=1"),
          std::string("set\nx=" + std::string(8000, '['))}) {
        sendto(raw, words.data(), words.size(), 0, static_cast<sockaddr*>(static_cast<void*>(&name)),
               sizeof name);
    }
    close(raw);
    const Ended refused = run_netem({"set", "--control", control, "loss=\xff\xfe"});
    EXPECT_EQ(refused.code, 2) << refused.said;
    EXPECT_TRUE(client.round_trip("still here"));
    EXPECT_EQ(run_netem({"show", "--control", control}).code, 0);
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
    EXPECT_EQ(run_netem({"log", "/nowhere"}).code, 5);
    const Ended help = run_netem({"--help"});
    EXPECT_EQ(help.code, 0);
    EXPECT_THAT(help.printed, HasSubstr("thimble-netem --listen 9000"));
    EXPECT_THAT(run_netem({"node", "--help"}).printed, HasSubstr("--base-port"));
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

}  // namespace
}  // namespace thimble
