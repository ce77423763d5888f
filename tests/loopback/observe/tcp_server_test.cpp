// One who tells many, none of whom can hold it up.
#include "common/runtime/tcp_server.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {
namespace {

class PlainClient {
  public:
    explicit PlainClient(std::uint16_t port) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        address.sin_port = htons(port);
        EXPECT_EQ(connect(socket_, static_cast<sockaddr*>(static_cast<void*>(&address)), sizeof address), 0);
    }
    ~PlainClient() { hang_up(); }
    PlainClient(const PlainClient&) = delete;
    PlainClient& operator=(const PlainClient&) = delete;

    void hang_up() {
        if (socket_ >= 0) close(socket_);
        socket_ = -1;
    }
    void say(std::size_t bytes) const {
        const std::vector<std::uint8_t> words(bytes, 7);
        EXPECT_EQ(::send(socket_, words.data(), words.size(), MSG_NOSIGNAL), static_cast<ssize_t>(bytes));
    }
    // Everything that is there, or comes while there is more.
    std::vector<std::uint8_t> hear(std::size_t least) const {
        std::vector<std::uint8_t> all(least);
        const auto size = recv(socket_, all.data(), least, MSG_WAITALL);
        all.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
        return all;
    }

  private:
    int socket_;
};

bool comes_to(TcpServer& server, std::size_t clients) {
    return wait_until([&] {
        server.look_after_clients();
        return server.clients() == clients;
    });
}

TEST(TcpServers, WhoIsTooSlowMissesWholeMessages) {
    TcpServer server({"127.0.0.1", 0});
    const PlainClient quick(server.port()), slow(server.port());
    ASSERT_TRUE(comes_to(server, 2));
    constexpr std::size_t kBytes = 100'000;
    std::size_t said = 0;
    for (; server.skipped() == 0; ++said) {
        const std::vector<std::uint8_t> message(kBytes, static_cast<std::uint8_t>(said));
        server.send(message);
        ASSERT_LT(said, 1000U);
        // The quick one takes it, however it comes.
        std::size_t left = kBytes;
        while (left > 0) {
            left -= quick.hear(std::min<std::size_t>(left, 10'000)).size();
            server.all_sent();
        }
    }
    EXPECT_FALSE(server.all_sent());
    const std::vector<std::uint8_t> heard = slow.hear(kBytes);
    EXPECT_EQ(heard, std::vector<std::uint8_t>(kBytes, 0));  // what it has is whole, and from the beginning
}

TEST(TcpServers, WhatClientsSayIsThrownAwayAndWhoHasGoneForgotten) {
    TcpServer server({"127.0.0.1", 0});
    PlainClient talker(server.port());
    ASSERT_TRUE(comes_to(server, 1));
    talker.say(1000);
    server.look_after_clients();
    EXPECT_EQ(server.clients(), 1U);
    talker.hang_up();
    EXPECT_TRUE(comes_to(server, 0));
    server.send(std::vector<std::uint8_t>(10));
}

TEST(TcpServers, ATakenPortIsAnErrorThatNamesIt) {
    const TcpServer server({"127.0.0.1", 0});
    EXPECT_THROW(TcpServer({"127.0.0.1", server.port()}), Error);
}

}  // namespace
}  // namespace thimble
