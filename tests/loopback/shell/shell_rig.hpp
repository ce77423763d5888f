// For tests of thimble-netem shell and pair: the program as users start it, and servers outside of its namespaces.
#pragma once

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <netinet/in.h>
#include <poll.h>
#include <string>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include <gtest/gtest.h>

#include "common/process/child.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {

inline std::string netem_program() {
    return (std::filesystem::path(THIMBLE_BIN_DIR) / "thimble-netem").string();
}

// Options of thimble-netem as words in a line, and the programs behind each "--" as scripts of sh.
inline std::vector<std::string> netem_words(const std::string& options,
                                            const std::vector<std::string>& scripts) {
    std::vector<std::string> words = words_in(options);
    for (const std::string& script : scripts) words.insert(words.end(), {"--", "sh", "-c", script});
    return words;
}

// Skipped, with the program's own reason, where namespaces or TUN devices are off.
class ShellTest : public testing::Test {
  protected:
    void SetUp() override {
        static const ProgramResult tried = netem("shell", {"true"});
        if (tried.exit_code == 3) GTEST_SKIP() << tried.output;
    }
    ProgramResult netem(const std::string& options, const std::vector<std::string>& scripts) const {
        return run_program(netem_program(), netem_words(options, scripts), folder_ / "", "build it");
    }
    static bool has(const std::string& program) {
        return std::system(("PATH=$PATH:/usr/sbin command -v " + program + " > /dev/null").c_str()) == 0;
    }
    Folder folder_;
};

#define THIMBLE_NEEDS(program, package) \
    if (!has(program)) GTEST_SKIP() << "there is no " program " (package " package ")"

// A socket of this machine on all addresses, of IPv4 and, where the kernel has it, of IPv6; a thread hands what comes to `answer`.
class OuterServer {
  public:
    OuterServer(int type, std::function<void(int socket)> answer)
        : socket_(::socket(AF_INET6, type | SOCK_CLOEXEC, 0)) {
        sockaddr_in6 address{};  // begins as that of IPv4
        address.sin6_family = socket_ >= 0 ? AF_INET6 : AF_INET;
        if (socket_ < 0) socket_ = ::socket(AF_INET, type | SOCK_CLOEXEC, 0);
        socklen_t size = sizeof address;
        auto* raw = static_cast<sockaddr*>(static_cast<void*>(&address));
        EXPECT_EQ(bind(socket_, raw, size), 0);
        EXPECT_TRUE(type != SOCK_STREAM || listen(socket_, 8) == 0);
        getsockname(socket_, raw, &size);
        port_ = ntohs(address.sin6_port);
        thread_ = std::thread([this, answer = std::move(answer)] {
            while (!stop_) {
                pollfd wanted{socket_, POLLIN, 0};
                if (poll(&wanted, 1, 20) > 0) answer(socket_);
            }
        });
    }
    ~OuterServer() {
        stop_ = true;
        thread_.join();
        close(socket_);
    }
    OuterServer(const OuterServer&) = delete;
    OuterServer& operator=(const OuterServer&) = delete;
    std::string port() const { return std::to_string(port_); }

  private:
    int socket_;
    std::uint16_t port_ = 0;
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

// The least round trip in what ping has said, ms; -1 if there is none.
inline double least_ping_ms(const std::string& words) {
    const std::size_t at = words.find("mdev = ");
    return at == std::string::npos ? -1 : std::stod(words.substr(at + 7));
}

}  // namespace thimble
