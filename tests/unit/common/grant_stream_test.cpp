// Grants over TCP: only a program with the run's key is let in, and no message is changed on its way.
#include "common/runtime/grant_stream.hpp"

#include <array>
#include <future>
#include <memory>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/runtime/udp_socket.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/text_file.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

// A TCP socket on a port of the kernel's choice, and where that is.
Endpoint bind_somewhere(int socket) {
    sockaddr_in address = UdpAddress::resolved("127.0.0.1", 0, "").generic();
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(socket, raw(address), size), 0);
    EXPECT_EQ(getsockname(socket, static_cast<sockaddr*>(static_cast<void*>(&address)), &size), 0);
    return {"127.0.0.1", ntohs(address.sin_port)};
}

Endpoint free_port() {
    const FileDescriptor probe(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    return bind_somewhere(probe.get());
}

using Taken = std::unique_ptr<GrantStream>;

Taken take_within(GrantDoor& door, Duration limit) {
    const SessionTime end = wall_now() + limit;
    for (Taken taken = door.take();; taken = door.take()) {
        if (taken || wall_now() > end) return taken;
        wall_sleep(std::chrono::milliseconds{1});
    }
}

// Bytes pass it both ways; once asked, it changes one that goes to the node.
class MeddlingWire {
  public:
    // `conductor`, `node`: descriptors, which it takes.
    MeddlingWire(int conductor, int node) : ends_{conductor, node} {}
    ~MeddlingWire() {
        for (const int end : ends_) close(end);
    }
    void pass(std::size_t from, std::size_t bytes, bool meddle = false) {
        std::array<std::uint8_t, 128> buffer{};
        ASSERT_EQ(recv(ends_.at(from), buffer.data(), bytes, MSG_WAITALL), static_cast<ssize_t>(bytes));
        if (meddle) buffer[8] ^= 1U;  // of the time
        ASSERT_EQ(send(ends_.at(1 - from), buffer.data(), bytes, MSG_NOSIGNAL), static_cast<ssize_t>(bytes));
    }

  private:
    std::array<int, 2> ends_;
};

class Grants : public testing::Test {
  protected:
    std::future<Taken> node_with(const SecretKey& key, const Endpoint& there) {
        return std::async(std::launch::async,
                          [=] { return GrantStream::to_conductor(there, key, "thimble-netem"); });
    }
    Endpoint here_ = free_port();
    GrantDoor door_{here_};
};

TEST_F(Grants, ANodeWithTheKeyTalksWithItsConductor) {
    auto coming = node_with(read_grant_key(grant_key_text(door_.key())), here_);
    Taken taken = take_within(door_, std::chrono::seconds{5});
    ASSERT_TRUE(taken);
    EXPECT_EQ(taken->program(), "thimble-netem");
    LockStepEnd conductor(std::move(taken), std::chrono::seconds{5});
    LockStepEnd node(coming.get(), Duration{});
    for (std::int64_t time_ns = 1; time_ns < 4; ++time_ns) {
        LockStepMessage message;
        message.kind = LockStepKind::kGrant;
        message.time_ns = time_ns;
        ASSERT_TRUE(conductor.send(message));
        EXPECT_EQ(node.receive()->time_ns, time_ns);
        message.kind = LockStepKind::kAnswer;
        ASSERT_TRUE(node.send(message));
        EXPECT_EQ(conductor.receive()->kind, LockStepKind::kAnswer);
    }
}

TEST_F(Grants, AStrangerIsNotLetInAndSaysSo) {
    SecretKey other = door_.key();
    other.bytes[3] ^= 1U;
    auto coming_stranger = node_with(other, here_);
    EXPECT_FALSE(take_within(door_, std::chrono::milliseconds{300}));
    LockStepEnd stranger(coming_stranger.get(), std::chrono::seconds{5});
    EXPECT_THAT(refusal([&] { stranger.receive(); }, ExitCode::kNetwork),
                HasSubstr("the lock-step controller rejected this program: it has another key or version"));
    auto coming = node_with(door_.key(), here_);
    EXPECT_TRUE(take_within(door_, std::chrono::seconds{5}));
    coming.wait();
}

// More of them than the door keeps.
TEST_F(Grants, ConnectionsThatSayNothingKeepNoNodeOut) {
    const auto way = UdpAddress::resolved(here_.host, here_.port, "").generic();
    std::vector<std::unique_ptr<FileDescriptor>> idle;
    idle.reserve(300);
    for (int i = 0; i < 300; ++i) {
        idle.push_back(std::make_unique<FileDescriptor>(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)));
        ASSERT_EQ(connect(idle.back()->get(), raw(way), sizeof way), 0);
        if (i >= 290) continue;  // the node waits behind these
        EXPECT_FALSE(door_.take());
    }
    auto coming = node_with(door_.key(), here_);
    EXPECT_TRUE(take_within(door_, std::chrono::seconds{5}));
    EXPECT_TRUE(coming.get());
    EXPECT_FALSE(take_within(door_, std::chrono::milliseconds{1200}));
    std::uint8_t byte = 0;
    for (const auto& one : idle) {
        ssize_t size = 1;
        while (size > 0) size = recv(one->get(), &byte, 1, MSG_DONTWAIT);
        EXPECT_EQ(size, 0) << "it is still connected";
    }
}

TEST_F(Grants, AMessageThatIsChangedOnItsWayIsRefused) {
    const auto way = UdpAddress::resolved(here_.host, here_.port, "").generic();
    const int listening = socket(AF_INET, SOCK_STREAM, 0), to_door = socket(AF_INET, SOCK_STREAM, 0);
    const Endpoint beside = bind_somewhere(listening);
    ASSERT_EQ(listen(listening, 1), 0);
    auto coming = node_with(door_.key(), beside);
    ASSERT_EQ(connect(to_door, raw(way), sizeof way), 0);
    MeddlingWire wire(to_door, accept(listening, nullptr, nullptr));
    close(listening);
    auto taking =
        std::async(std::launch::async, [this] { return take_within(door_, std::chrono::seconds{5}); });
    wire.pass(0, 32);
    wire.pass(1, 96);
    const Taken conductor = taking.get(), node = coming.get();
    ASSERT_TRUE(conductor && node);
    LockStepMessage message;
    ASSERT_TRUE(conductor->send(message));
    wire.pass(0, 128, true);
    EXPECT_THAT(refusal([&] { node->receive(message); }, ExitCode::kNetwork),
                HasSubstr("fails the check with the run's key"));
}

// None can be opened for as long as this lives.
class NoDescriptors {
  public:
    // The sanitizer needs descriptors when it first meets a class with virtual functions, such as that of an error's words.
    NoDescriptors() {
        static_cast<void>(fmt::format("{}{}", "", ""));
        getrlimit(RLIMIT_NOFILE, &before_);
        const rlimit none{0, before_.rlim_max};
        setrlimit(RLIMIT_NOFILE, &none);
    }
    ~NoDescriptors() { setrlimit(RLIMIT_NOFILE, &before_); }
    NoDescriptors(const NoDescriptors&) = delete;
    NoDescriptors& operator=(const NoDescriptors&) = delete;

  private:
    rlimit before_{};
};

TEST_F(Grants, OutOfFileDescriptorsIsSaidInWords) {
    // Copies: this test is such a class, too.
    const auto node = [here = here_, key = door_.key()] {
        const NoDescriptors none;
        GrantStream::to_conductor(here, key, "thimble-netem");
    };
    const auto door = [here = here_] {
        const NoDescriptors none;
        GrantDoor{here};
    };
    constexpr const char* kWords = "cannot open a TCP socket: Too many open files; raise 'ulimit -n'";
    EXPECT_EQ(refusal(node, ExitCode::kNetwork), kWords);
    EXPECT_EQ(refusal(door, ExitCode::kNetwork), kWords);
}

TEST(GrantKey, MustBeAKey) {
    EXPECT_THAT(refusal([] { read_grant_key("c0ffee"); }, ExitCode::kUsage),
                HasSubstr("64 hexadecimal digits"));
}

TEST(GrantKey, WithoutAConductorANodeSaysWhere) {
    EXPECT_THAT(refusal(
                    [] {
                        GrantStream::to_conductor({"127.0.0.1", 1}, {}, "thimble-netem");
                    },
                    ExitCode::kNetwork),
                HasSubstr("TCP 127.0.0.1:1"));
}

}  // namespace
}  // namespace thimble
