// thimble-netem shell around small scripts: what a program finds behind the link, and what it leaves.
#include <array>
#include <atomic>
#include <csignal>
#include <fstream>
#include <mutex>
#include <set>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "common/runtime/udp_channel.hpp"
#include "tests/loopback/shell/shell_rig.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;
using testing::Not;

struct ShellProgram : ShellTest {};

TEST_F(ShellProgram, ExitCodeIsThePrograms) {
    EXPECT_EQ(netem("shell", {"exit 7"}).exit_code, 7);
    EXPECT_EQ(netem("shell", {"kill -9 $$"}).exit_code, 137);
}

TEST_F(ShellProgram, EndsWhereItsParentIgnoresChildren) {
    const std::string words = "trap '' CHLD; exec " + netem_program() + " shell -- sh -c 'exit 7'";
    EXPECT_EQ(run_program("sh", {"-c", words}, folder_ / "", "install it").exit_code, 7);
}

TEST_F(ShellProgram, FolderUserAndEnvironmentStay) {
    setenv("THIMBLE_TEST_WORD", "kept", 1);
    const ProgramResult result =
        netem("shell", {"pwd; echo $(id -u) $THIMBLE_TEST_WORD at $THIMBLE_HOST; cat /proc/net/dev"});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_THAT(result.output, HasSubstr("thimble-"));
    EXPECT_THAT(result.output, HasSubstr(std::to_string(getuid()) + " kept at 10."));
    EXPECT_THAT(result.output, HasSubstr("link:"));
    EXPECT_THAT(result.output, Not(HasSubstr("eth")));
}

TEST_F(ShellProgram, RefusesWhatItCannotStart) {
    const ProgramResult absent =
        run_program(netem_program(), {"shell", "--", "no-such-program"}, folder_ / "", "build it");
    EXPECT_EQ(absent.exit_code, 2);
    EXPECT_THAT(absent.output, HasSubstr("cannot start 'no-such-program'"));
    EXPECT_EQ(netem("shell --uplink nonsense", {"true"}).exit_code, 2);
    EXPECT_EQ(netem("pair", {"true"}).exit_code, 2);
}

TEST_F(ShellProgram, SignalsGoOnToTheProgram) {
    Child child(netem_program(),
                netem_words("shell", {"trap 'exit 5' TERM; echo > ready; while :; do sleep 0.05; done"}),
                folder_ / "words", {}, {.directory = folder_ / ""});
    ASSERT_TRUE(wait_until([&] { return std::filesystem::exists(folder_ / "ready"); }));
    child.signal(SIGTERM);
    EXPECT_EQ(child.wait(kPatience), 5);
}

bool lives(const std::string& mark) {
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
        std::ifstream file(entry.path() / "cmdline");
        std::string words;
        std::getline(file, words);
        if (words.starts_with("sleep") && words.find(mark) != std::string::npos) return true;
    }
    return false;
}

TEST_F(ShellProgram, LeavesNoProcess) {
    const std::string mark = std::to_string(100'000 + getpid());
    const ProgramResult result =
        netem("shell", {"setsid sleep " + mark + " > /dev/null 2>&1 & sleep 0.1; exit 3"});
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_FALSE(lives(mark));
}

// A script that waits until its daemon is gone comes to an end.
TEST_F(ShellProgram, AnOrphanThatEndsIsGone) {
    const ProgramResult result =
        netem("shell", {"(sleep 1000 > /dev/null 2>&1 & echo $! > pid); p=$(cat pid); kill $p; "
                        "for i in $(seq 600); do kill -0 $p 2> /dev/null || exit 4; sleep 0.05; done"});
    EXPECT_EQ(result.exit_code, 4);
}

// The numbers of datagrams that arrive of 300.
std::set<int> arrived(const std::function<ProgramResult(const std::string& port)>& send) {
    std::mutex lock;
    std::set<int> numbers;
    std::atomic<bool> all_came{false};
    const OuterServer server(SOCK_DGRAM, [&](int socket) {
        std::array<char, 64> room{};
        const auto size = recv(socket, room.data(), room.size() - 1, 0);
        const int number = size > 0 ? std::stoi(room.data()) : 0;
        const std::scoped_lock held(lock);
        if (number > 0) numbers.insert(number);
        all_came = all_came || (size > 0 && number == 0);
    });
    EXPECT_EQ(send(server.port()).exit_code, 0);
    // Behind what is still in the server's socket.
    UdpChannel last(std::nullopt, {"127.0.0.1", static_cast<std::uint16_t>(std::stoi(server.port()))});
    EXPECT_TRUE(wait_until([&] {
        last.send(std::array<std::uint8_t, 1>{'0'});
        return all_came.load();
    }));
    const std::scoped_lock held(lock);
    return numbers;
}

TEST_F(ShellProgram, FatesAreThoseOfTheSeed) {
    THIMBLE_NEEDS("bash", "bash");
    const auto with = [this](const std::vector<std::string>& options) {
        return arrived([&](const std::string& port) {
            std::vector<std::string> words = words_in("shell --link up.loss=0.2", options);
            words.insert(words.end(), {"--", "bash", "-c",
                                       "exec 3> /dev/udp/$THIMBLE_HOST/" + port +
                                           "; for i in {1..300}; do echo $i >&3; done"});
            return run_program(netem_program(), words, folder_ / "", "build it");
        });
    };
    const std::set<int> first = with({"--seed", "5"});
    EXPECT_EQ(first, with({"--uplink", "loss 20% seed 5"}));
    EXPECT_NE(first, with({"--uplink", "loss 20% seed 5", "--seed", "6"}));
    EXPECT_GT(first.size(), 180U);
    EXPECT_LT(first.size(), 290U);
}

TEST_F(ShellProgram, ReportsAndLogs) {
    THIMBLE_NEEDS("bash", "bash");
    const ProgramResult result = run_program(
        netem_program(),
        words_in("shell --json --log log.csv",
                 {"--uplink", "delay 10ms", "--downlink", "tc qdisc add dev ifb0 root netem delay 20ms", "--",
                  "bash", "-c", "echo > /dev/udp/$THIMBLE_HOST/9"}),
        folder_ / "", "build it");
    EXPECT_THAT(result.output, Not(HasSubstr("add `both`")));
    const auto report = nlohmann::json::parse(result.output.substr(result.output.find('{')));
    EXPECT_EQ(report.at("up").at("asked").at("delay_s"), 0.01);
    EXPECT_EQ(report.at("down").at("asked").at("delay_s"), 0.02);
    EXPECT_GE(report.at("up").at("delay").at("achieved_mean_s").get<double>(), 0.01);
    EXPECT_TRUE(report.at("shell").contains("no_ip_packets"));
    EXPECT_GT(report.at("shell").at("sending").at("writing").at("count"), 0);
    EXPECT_THAT(read_text(folder_ / "log.csv"), HasSubstr("received"));
}

TEST_F(ShellProgram, KeepsTheProgramsExitCodeThoughItsLogHasNoRoom) {
    for (const auto& [script, code] : {std::pair{"exit 7", 7}, {"exit 0", 5}}) {
        const ProgramResult result = netem("shell --log /dev/full", {script});
        EXPECT_EQ(result.exit_code, code);
        EXPECT_THAT(result.output, AllOf(HasSubstr("is incomplete"), HasSubstr("waiting")));
    }
}

TEST_F(ShellProgram, ObeysSetWhileItRuns) {
    Child child(netem_program(),
                netem_words("shell --control control", {"while [ ! -e end ]; do sleep 0.05; done"}),
                folder_ / "words", {}, {.directory = folder_ / ""});
    ASSERT_TRUE(wait_until([&] { return std::filesystem::exists(folder_ / "control"); }));
    const ProgramResult set = run_program(
        netem_program(), words_in("set --control control down.delay_s=0.25"), folder_ / "", "build it");
    EXPECT_EQ(set.exit_code, 0) << set.output;
    const ProgramResult show =
        run_program(netem_program(), words_in("show --control control --json"), folder_ / "", "build it");
    EXPECT_THAT(show.output, HasSubstr("0.25"));
    static_cast<void>(folder_.write("end", ""));
    EXPECT_EQ(child.wait(kPatience), 0);
}

TEST_F(ShellProgram, TestsItself) {
    const ProgramResult test = run_program(
        netem_program(),
        words_in(
            "shell --selftest --seconds 1 --json --link delay_s=0.02 loss=0.05 corrupt=0.05 duplicate=0.05 "
            "jitter=uniform jitter_spread_s=0.005"),
        folder_ / "", "build it");
    ASSERT_TRUE(test.exit_code == 0 || test.exit_code == 1) << test.output;
    const auto result = nlohmann::json::parse(test.output.substr(test.output.find('{')));
    EXPECT_EQ(result.at("verdict") == "FAIL", test.exit_code == 1);
    for (const char* direction : {"up", "down"}) {
        EXPECT_EQ(result.at(direction).at("early"), 0) << direction;
        EXPECT_EQ(result.at(direction).at("other_fates"), 0) << direction;
        EXPECT_GT(result.at(direction).at("dropped_as_asked"), 0) << direction;
        EXPECT_GT(result.at(direction).at("arrived"), 100) << direction;
    }
    EXPECT_EQ(netem("shell --selftest", {"true"}).exit_code, 2);
    EXPECT_EQ(netem("shell --seconds 1", {"true"}).exit_code, 2);
}

TEST_F(ShellProgram, RefusesAFolderThatIsTooLongForASocket) {
    const std::filesystem::path longest = folder_ / std::string(100, 'x');
    std::filesystem::create_directory(longest);
    const ProgramResult result = run_program(
        "env", {"TMPDIR=" + longest.string(), netem_program(), "shell", "--", "true"}, folder_ / "", "");
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.output, HasSubstr("TMPDIR"));
}

TEST_F(ShellProgram, SaysWhatToSwitchOn) {
    const std::string hidden = "unshare -m" + std::string(getuid() == 0 ? "" : "Ur") +
                               " sh -c 'mount -t tmpfs none /dev/net && " + netem_program() +
                               " shell -- true'";
    const ProgramResult result = run_program("sh", {"-c", hidden}, folder_ / "", "install it");
    // 1 is from unshare, 32 from mount.
    if (result.exit_code == 1 || result.exit_code == 32)
        GTEST_SKIP() << "no mount namespaces here: " << result.output;
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_THAT(result.output, HasSubstr("modprobe tun"));
}

// The test limits a user namespace of its own. Without SYS_ADMIN the root of that namespace is as any user.
TEST_F(ShellProgram, NamesTheSysctlThatForbidsNamespaces) {
    THIMBLE_NEEDS("setpriv", "util-linux");
    const std::string limited =
        "echo 0 > /proc/sys/user/max_user_namespaces || exit 77; exec setpriv "
        "--bounding-set -sys_admin " +
        netem_program() + " pair -- true -- true";
    const ProgramResult result =
        run_program("unshare", {"-Ur", "sh", "-c", limited}, folder_ / "", "install it");
    if (result.exit_code == 1 || result.exit_code == 77)
        GTEST_SKIP() << "no user namespace with a limit of its own here: " << result.output;
    EXPECT_EQ(result.exit_code, 3) << result.output;
    EXPECT_THAT(result.output, HasSubstr("No space left on device"));  // as the kernel calls that limit
    EXPECT_THAT(result.output, HasSubstr("sysctl -w user.max_user_namespaces=10000"));
}

}  // namespace
}  // namespace thimble
