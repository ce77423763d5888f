// thimble-netem pair: two programs and the link between them.
#include <algorithm>
#include <csignal>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/loopback/shell/shell_rig.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

struct PairProgram : ShellTest {};

TEST_F(PairProgram, EachReachesTheOtherAndAllEndWithTheFirst) {
    THIMBLE_NEEDS("ping", "iputils-ping");
    const ProgramResult result =
        netem("pair --link delay_s=0.01", {"sleep 1000", "ping -c 3 -i 0.1 $THIMBLE_HOST"});
    EXPECT_EQ(result.exit_code, 0) << result.output;
    EXPECT_THAT(result.output, HasSubstr("3 received"));
    EXPECT_GE(least_ping_ms(result.output), 20) << result.output;
}

TEST_F(PairProgram, ExitCodeIsTheFirstThatIsNotZero) {
    EXPECT_EQ(netem("pair", {"sleep 1000", "exit 4"}).exit_code, 4);
    EXPECT_EQ(netem("pair", {"exit 6", "trap 'exit 1' TERM; while :; do sleep 0.05; done"}).exit_code, 6);
}

TEST_F(PairProgram, ExitCodeOfAProgramThatIsAskedToEndDoesNotCount) {
    const std::string server = "trap 'exit 1' TERM; echo > ready; while :; do sleep 0.05; done";
    const std::string client = "while [ ! -e ready ]; do sleep 0.05; done";
    EXPECT_EQ(netem("pair", {server, client}).exit_code, 0);
}

TEST_F(PairProgram, CtrlCEndsBoth) {
    Child child(netem_program(), netem_words("pair", {"sleep 1000", "echo > ready; sleep 1000"}),
                folder_ / "words", {}, {.directory = folder_ / ""});
    ASSERT_TRUE(wait_until([&] { return std::filesystem::exists(folder_ / "ready"); }));
    child.signal(SIGINT);
    EXPECT_EQ(child.wait(kPatience), 128 + SIGINT);
}

// Of DDS discovery: one side joins a group, the other one speaks to it.
TEST_F(PairProgram, MulticastComesAcross) {
    THIMBLE_NEEDS("python3", "python3-minimal");
    const ProgramResult result =
        netem("pair --link delay_s=0.01", {"python3 -c \"import socket, time\ns = "
                                           "socket.socket(socket.AF_INET, socket.SOCK_DGRAM)\nwhile True:\n"
                                           "  s.sendto(b'found', ('239.255.0.1', 7400)); time.sleep(0.1)\"",
                                           "python3 -c \"import socket\ns = socket.socket(socket.AF_INET, "
                                           "socket.SOCK_DGRAM)\ns.bind(('', 7400))\n"
                                           "s.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, "
                                           "socket.inet_aton('239.255.0.1') + bytes(4))\n"
                                           "s.settimeout(60)\nprint(s.recvfrom(100))\""});
    EXPECT_EQ(result.exit_code, 0) << result.output;
    EXPECT_THAT(result.output, HasSubstr("b'found', ('10.77.0.1'"));
}

// Two participants of CycloneDDS find each other by multicast. Its one-way time is half of the round trip.
TEST_F(PairProgram, DdsFindsItsPeer) {
    THIMBLE_NEEDS("ddsperf", "cyclonedds-tools");
    const ProgramResult result =
        netem("pair --link delay_s=0.02", {"ddsperf -D 30 pong", "ddsperf -D 2 -Q minmatch:1 ping 20Hz"});
    EXPECT_EQ(result.exit_code, 0) << result.output;
    const std::size_t least = result.output.find(" min ");
    ASSERT_NE(least, std::string::npos) << result.output;
    EXPECT_GE(std::stod(result.output.substr(least + 5)), 20'000) << result.output;
}

// Two pages of headless browsers, and a data channel between them. Only the first side serves the page.
TEST_F(PairProgram, PagesTalkOverWebRtc) {
    THIMBLE_NEEDS("chromium", "chromium");
    THIMBLE_NEEDS("python3", "python3-minimal");
    const std::string page = "exec python3 -B " THIMBLE_WEB_RTC " ";
    const ProgramResult result =
        netem("pair --link delay_s=0.02", {page + "first", "sleep 0.5; " + page + "second"});
    ASSERT_EQ(result.exit_code, 0) << result.output;
    const std::string from = result.output.substr(std::min(result.output.find('{'), result.output.size()));
    const auto found = nlohmann::json::parse(from.substr(0, from.find('}') + 1), nullptr, false);
    ASSERT_TRUE(found.is_object()) << result.output;
    EXPECT_GE(found.at("least_ms"), 40);
    EXPECT_EQ(found.at("candidates"), nlohmann::json({"host", "host"}));
}

}  // namespace
}  // namespace thimble
