// A node under a service manager: what systemd would hear on its socket, here a test's.
#include <array>
#include <cstdlib>
#include <cstring>
#include <string>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/loopback/lone_node.hpp"

namespace thimble {
namespace {

using testing::EndsWith;
using testing::StartsWith;

class NotifySocket {
  public:
    explicit NotifySocket(const std::string& path)
        : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        std::memcpy(address.sun_path, path.data(), path.size());
        const auto* generic = static_cast<const sockaddr*>(static_cast<const void*>(&address));
        if (bind(socket_, generic, sizeof address) != 0) throw std::runtime_error("cannot bind " + path);
        setenv("NOTIFY_SOCKET", path.c_str(), 1);
        setenv("WATCHDOG_USEC", "200000", 1);
    }
    ~NotifySocket() {
        close(socket_);
        unsetenv("NOTIFY_SOCKET");
        unsetenv("WATCHDOG_USEC");
    }
    NotifySocket(const NotifySocket&) = delete;
    NotifySocket& operator=(const NotifySocket&) = delete;

    // Everything so far, a line each.
    const std::string& heard() {
        std::array<char, 100> word{};
        for (ssize_t n; (n = recv(socket_, word.data(), word.size(), MSG_DONTWAIT)) > 0;)
            heard_ += std::string(word.data(), static_cast<std::size_t>(n)) + "\n";
        return heard_;
    }

  private:
    int socket_;
    std::string heard_;
};

TEST(Service, ANodeSaysWhenItListensThatItTurnsAndWhenItStops) {
    const Folder folder;
    for (const char* program : kNodePrograms) {
        NotifySocket manager((folder / program).string());
        LoneNode node(program);
        ASSERT_TRUE(node.ready()) << node.words();
        EXPECT_TRUE(wait_until([&] {
            return manager.heard().find("WATCHDOG=1\nWATCHDOG=1") != std::string::npos;
        })) << manager.heard();
        EXPECT_EQ(node.terminate(), 0);
        EXPECT_THAT(manager.heard(), StartsWith("READY=1\n"));
        EXPECT_THAT(manager.heard(), EndsWith("STOPPING=1\n"));
    }
}

}  // namespace
}  // namespace thimble
