// thimble-netem in front of an echo server. Clocks are asked for order and wide bounds only.
#include <arpa/inet.h>
#include <atomic>
#include <csignal>
#include <fcntl.h>
#include <optional>
#include <poll.h>
#include <stdexcept>
#include <string>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/process/child.hpp"
#include "common/runtime/udp_socket.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/time.hpp"
#include "netem/relay/datagram_batch.hpp"
#include "netem/relay/packet_record.hpp"
#include "netem/relay/relay_report.hpp"
#include "netem/relay/request_server.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using testing::HasSubstr;

// thimble-netem as its users start it, and an echo server to put it in front of.
bool readable(const UdpSocket& socket, Duration patience) {
    pollfd wanted{socket.descriptor(), POLLIN, 0};
    return poll(&wanted, 1, static_cast<int>(patience / std::chrono::milliseconds{1})) > 0;
}

void send(const UdpSocket& socket, Bytes bytes, const UdpAddress* to) {
    SendBatch batch;
    batch.add(bytes, to);
    batch.send(socket.descriptor());
}

UdpAddress loopback() { return {htonl(INADDR_LOOPBACK), 0}; }

// Started with these arguments; killed if it still runs at the end of the test.
class NetemProgram {
  public:
    explicit NetemProgram(const std::vector<std::string>& arguments)
        : printed_(open((folder_ / "out").c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0600)),
          child_(std::filesystem::path(THIMBLE_BIN_DIR) / "thimble-netem", arguments, folder_ / "err",
                 {.output = printed_}) {}
    ~NetemProgram() { close(printed_); }
    NetemProgram(const NetemProgram&) = delete;
    NetemProgram& operator=(const NetemProgram&) = delete;

    void signal(int number) { child_.signal(number); }
    int wait() { return child_.wait(kPatience).value_or(-1); }  // its exit code; -1 if it does not end
    std::string said() const { return read_text(folder_ / "err"); }
    std::string printed() const { return read_text(folder_ / "out"); }
    // Where its n-th inlet listens, once it is ready.
    UdpAddress inlet(int n = 0) {
        const std::string mark = "ready: UDP ";
        std::size_t at = 0;
        std::string words;
        const bool ready = wait_until([&] {
            words = said();
            at = words.find(mark);
            for (int i = 0; i < n && at != std::string::npos; ++i) at = words.find(mark, at + 1);
            return at != std::string::npos && words.find('\n', at) != std::string::npos;
        });
        if (!ready) throw std::runtime_error("not ready: " + words);
        at += mark.size();
        return read_udp_address(words.substr(at, words.find(' ', at) - at), "its own words");
    }

  private:
    Folder folder_;
    int printed_;
    Child child_;
};

struct Ended {
    int code;
    std::string printed, said;
};
Ended run_netem(const std::vector<std::string>& arguments) {
    NetemProgram program(arguments);
    const int code = program.wait();
    return {code, program.printed(), program.said()};
}

// Answers each datagram with the same bytes.
class EchoServer {
  public:
    EchoServer() : socket_(UdpSocket::listening(loopback())) {
        thread_ = std::thread([this] {
            ReceiveBatch batch;
            while (!stop_) {
                if (!readable(socket_, std::chrono::milliseconds{20})) continue;
                const std::size_t count = batch.receive(socket_.descriptor());
                for (std::size_t i = 0; i < count; ++i) {
                    const auto datagram = batch[i];
                    send(socket_, datagram.bytes, &datagram.from);
                }
            }
        });
    }
    ~EchoServer() {
        stop_ = true;
        thread_.join();
    }
    std::string address() const { return to_string(socket_.local()); }

  private:
    UdpSocket socket_;
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

class Client {
  public:
    explicit Client(const UdpAddress& relay) : socket_(UdpSocket::connected(relay)) {}
    void say(const std::string& words) const {
        send(socket_, {reinterpret_cast<const std::uint8_t*>(words.data()), words.size()}, nullptr);
    }
    std::optional<std::string> hear(Duration patience = kPatience) const {
        // One at a time: what else waits is for the next call.
        std::string words(65536, '\0');
        if (!readable(socket_, patience)) return std::nullopt;
        const auto size = recv(socket_.descriptor(), words.data(), words.size(), 0);
        if (size < 0) return std::nullopt;
        words.resize(static_cast<std::size_t>(size));
        return words;
    }
    // Says it and waits for the echo; how long that took.
    std::optional<Duration> round_trip(const std::string& words) const {
        const SessionTime start = wall_now();
        say(words);
        if (hear() != words) return std::nullopt;
        return wall_now() - start;
    }

  private:
    UdpSocket socket_;
};

class RelayProgram : public testing::Test {
  protected:
    std::vector<std::string> in_front(const std::vector<std::string>& more = {}) const {
        return words_in("--listen 127.0.0.1:0 --to " + echo_.address(), more);
    }
    EchoServer echo_;
    Folder folder_;
};

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
    for (const char* of_relay : {"--profile=lte", "-plte", "--metrics=9464"})
        EXPECT_THAT(run_netem({of_relay}).said, HasSubstr("--listen")) << of_relay;
}

TEST_F(RelayProgram, KeepsASettingThroughTheChangesOfAProfile) {
    const auto profile = folder_.write("changes.toml", "delay_s = 0.01\n[[change]]\nat_s = 0\nloss = 0.5\n");
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
    NetemProgram netem({"--listen", "127.0.0.1:0", "--to", "240.0.0.1:9"});
    Client(netem.inlet()).say("hello");
    EXPECT_TRUE(
        wait_until([&] { return netem.said().find("240.0.0.1:9") != netem.said().rfind("240.0.0.1:9"); }));
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
    NetemProgram test({"--selftest", "--seconds", "5", "--link", "delay_s=6"});
    EXPECT_TRUE(wait_until([&] { return test.said().find("the test ends") != std::string::npos; }));
    test.signal(SIGINT);
    EXPECT_EQ(test.wait(), 1);
    EXPECT_THAT(test.said(), HasSubstr("interrupted"));
    EXPECT_EQ(test.printed(), "");
}

}  // namespace
}  // namespace thimble
