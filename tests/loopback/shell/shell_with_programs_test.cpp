// Programs that people use, behind a link. Bounds are wide: a busy machine adds to delays, nothing takes away from them.
#include <array>
#include <cstring>

#include <gmock/gmock.h>

#include "tests/loopback/shell/shell_rig.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

struct ShellWithPrograms : ShellTest {
    // Whether iperf3 listens after it has served so many clients.
    bool listens_after(int clients) const {
        const std::string words = read_text(folder_ / "server");
        std::size_t at = 0;
        for (int i = 0; i <= clients && at != std::string::npos; ++i)
            at = words.find("Server listening", i == 0 ? 0 : at + 1);
        return at != std::string::npos;
    }
};

TEST_F(ShellWithPrograms, PingShowsTheDelay) {
    THIMBLE_NEEDS("ping", "iputils-ping");
    const std::string link = "shell --link up.delay_s=0.03 down.delay_s=0.02";
    for (const char* variable : {"$THIMBLE_HOST", "$THIMBLE_HOST6"}) {
        const ProgramResult result =
            netem(link, {"[ -n \"" + std::string(variable) + "\" ] || exit 9; ping -c 5 -i 0.1 " + variable});
        if (result.exit_code == 9) GTEST_SKIP() << "this kernel has no IPv6 in namespaces";
        EXPECT_EQ(result.exit_code, 0) << result.output;
        EXPECT_THAT(result.output, HasSubstr("5 received"));
        EXPECT_GE(least_ping_ms(result.output), 50) << result.output;
        EXPECT_LT(least_ping_ms(result.output), 100) << result.output;  // as if a delay came twice
    }
}

TEST_F(ShellWithPrograms, CurlReadsAPage) {
    THIMBLE_NEEDS("curl", "curl");
    const OuterServer server(SOCK_STREAM, [](int socket) {
        const int caller = accept(socket, nullptr, nullptr);
        std::array<char, 2000> request{};
        const std::string page(100'000, 'x');
        const std::string answer =
            "HTTP/1.0 200 OK\r\nContent-Length: " + std::to_string(page.size()) + "\r\n\r\n" + page;
        if (recv(caller, request.data(), request.size(), 0) > 0)
            send(caller, answer.data(), answer.size(), MSG_NOSIGNAL);
        close(caller);
    });
    const ProgramResult result =
        netem("shell --link delay_s=0.005 rate_bits_per_s=50e6",
              {"curl -sg --noproxy '*' http://$THIMBLE_HOST:" + server.port() + "/ | wc -c"});
    EXPECT_THAT(result.output, HasSubstr("100000\n"));
}

// More than a second's worth of its data waits in the kernel when the program ends.
TEST_F(ShellWithPrograms, AConnectionOutlivesItsProgram) {
    THIMBLE_NEEDS("bash", "bash");
    std::atomic<std::size_t> heard{0};
    std::atomic<bool> to_the_end{false};
    const OuterServer server(SOCK_STREAM, [&](int socket) {
        const int caller = accept(socket, nullptr, nullptr);
        const timeval patience{kPatience / std::chrono::seconds{1}, 0};
        setsockopt(caller, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
        std::array<char, 2000> room{};
        ssize_t size = 0;
        while ((size = recv(caller, room.data(), room.size(), 0)) > 0)
            heard += static_cast<std::size_t>(size);
        to_the_end = size == 0;
        close(caller);
    });
    const ProgramResult result =
        netem("shell --link up.rate_bits_per_s=300e3",
              {"exec bash -c \"head -c 60000 /dev/zero > /dev/tcp/$THIMBLE_HOST/" + server.port() + "\""});
    EXPECT_EQ(result.exit_code, 0) << result.output;
    EXPECT_TRUE(wait_until([&] { return to_the_end.load(); })) << heard;
    EXPECT_EQ(heard, 60'000U);
}

TEST_F(ShellWithPrograms, DigAsksANameServer) {
    THIMBLE_NEEDS("dig", "bind9-dnsutils");
    const OuterServer server(SOCK_DGRAM, [](int socket) {
        std::array<char, 600> room{};
        sockaddr_in6 from{};
        socklen_t size = sizeof from;
        auto* raw = static_cast<sockaddr*>(static_cast<void*>(&from));
        const auto got = recvfrom(socket, room.data(), 500, 0, raw, &size);
        if (got < 12) return;
        // The question ends behind its name, type and class; what may follow it is left out.
        const std::size_t end = 12 + std::strlen(room.data() + 12) + 5;
        const std::string answer("\xC0\x0C\0\1\0\1\0\0\0\1\0\4\xC0\0\2\7", 16);
        answer.copy(room.data() + end, answer.size());
        room[2] = static_cast<char>(room[2] | 0x80);
        room[7] = 1;
        room[11] = 0;
        sendto(socket, room.data(), end + answer.size(), 0, raw, size);
    });
    const ProgramResult result =
        netem("shell --link delay_s=0.01",
              {"dig +short +tries=1 -p " + server.port() + " @$THIMBLE_HOST robot.test A"});
    EXPECT_THAT(result.output, HasSubstr("192.0.2.7")) << result.output;
}

// A key and a daemon of the test's own, on a port of its own.
struct ShellWithSsh : ShellWithPrograms {
    void SetUp() override {
        ShellWithPrograms::SetUp();
        if (IsSkipped()) return;
        THIMBLE_NEEDS("sshd", "openssh-server");
        if (getuid() == 0) std::filesystem::create_directories("/run/sshd");
        const std::string keys =
            "ssh-keygen -q -t ed25519 -N '' -f host && ssh-keygen -q -t ed25519 -N '' -f me";
        ASSERT_EQ(run_program("sh", {"-c", keys}, folder_ / "", "install it").exit_code, 0);
    }
    std::string daemon() const {
        return "exec /usr/sbin/sshd -D -f /dev/null -h $PWD/host -p " + port_ +
               " -o AuthorizedKeysFile=$PWD/me.pub -o StrictModes=no -o UsePAM=no -o PidFile=none";
    }
    std::string ssh() const {
        return "ssh -F /dev/null -i me -p " + port_ +
               " -o StrictHostKeyChecking=no -o UserKnownHostsFile=/dev/null -o BatchMode=yes "
               "-o ConnectionAttempts=20";
    }

  private:
    PortBlock ports_;
    std::string port_ = std::to_string(ports_.base());
};

TEST_F(ShellWithSsh, SshRunsACommand) {
    Child server("sh", {"-c", daemon()}, folder_ / "daemon", {}, {.directory = folder_ / ""});
    const ProgramResult result = netem("shell --link delay_s=0.005",
                                       {ssh() + " $(id -un)@$THIMBLE_HOST 'echo over $((40 + 2)); exit 5'"});
    EXPECT_EQ(result.exit_code, 5) << result.output << read_text(folder_ / "daemon");
    EXPECT_THAT(result.output, HasSubstr("over 42"));
}

// ssh starts its server, and then both speak UDP. Its client needs a terminal that has a size.
TEST_F(ShellWithSsh, MoshShowsACommand) {
    THIMBLE_NEEDS("mosh", "mosh");
    static_cast<void>(folder_.write(
        "mosh.sh", "stty rows 24 cols 80\nmosh --ssh='" + ssh() +
                       "' $(id -un)@$THIMBLE_HOST -- sh -c 'echo over $((40 + 2)); sleep 0.3'\n"));
    const ProgramResult result =
        netem("pair --link delay_s=0.005 loss=0.02",
              {daemon(), "export TERM=xterm LC_ALL=C.UTF-8; script -qec 'sh mosh.sh' /dev/null"});
    EXPECT_EQ(result.exit_code, 0) << result.output;
    EXPECT_THAT(result.output, HasSubstr("over 42"));
}

TEST_F(ShellWithPrograms, QuicFetchesAPage) {
    THIMBLE_NEEDS("gtlsclient", "ngtcp2-client");
    THIMBLE_NEEDS("gtlsserver", "ngtcp2-server");
    const std::string certificate =
        "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -subj /CN=localhost -keyout "
        "key "
        "-out certificate -days 2";
    ASSERT_EQ(run_program("sh", {"-c", certificate}, folder_ / "", "install openssl").exit_code, 0);
    const std::string page(200'000, 'x');
    static_cast<void>(folder_.write("page", page));
    std::filesystem::create_directory(folder_ / "got");
    const ProgramResult result =
        netem("pair --link delay_s=0.005 loss=0.02",
              {"exec gtlsserver -q -d . 0.0.0.0 4433 key certificate",
               "for i in 1 2 3 4 5; do gtlsclient -q --exit-on-all-streams-close --handshake-timeout=3s "
               "--download=got $THIMBLE_HOST 4433 https://localhost/page && [ -s got/page ] && exit; "
               "sleep 0.3; done; exit 1"});
    EXPECT_EQ(result.exit_code, 0) << result.output;
    EXPECT_EQ(read_text(folder_ / "got" / "page"), page);
}

TEST_F(ShellWithPrograms, IperfHasTheRateBothWays) {
    THIMBLE_NEEDS("iperf3", "iperf3");
    const PortBlock ports;
    const std::string port = std::to_string(ports.base());
    Child server("iperf3", {"-s", "--forceflush", "-p", port}, folder_ / "server");
    for (const std::string way : {"", " -R"}) {
        // iperf3 writes that line again after each client. A connection of the test's own would count as a client.
        ASSERT_TRUE(wait_until([&] { return listens_after(way.empty() ? 0 : 1); }));
        const ProgramResult result =
            netem("shell --link delay_s=0.005 rate_bits_per_s=20e6 rate_queue_packets=200",
                  {"iperf3 -t 1 -f k -c $THIMBLE_HOST -p " + port + way + " | grep receiver"});
        const std::size_t at = result.output.find(" Kbits/sec");
        ASSERT_NE(at, std::string::npos) << result.output;
        const double kbits = std::stod(result.output.substr(result.output.rfind(' ', at - 1)));
        EXPECT_GT(kbits, 2'000) << result.output;
        EXPECT_LT(kbits, 20'000) << result.output;
    }
}

}  // namespace
}  // namespace thimble
