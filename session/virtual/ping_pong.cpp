#include "session/virtual/ping_pong.hpp"

#include <arpa/inet.h>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "common/error.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

constexpr std::size_t kBytes = 144;  // a force feedback

int loopback_socket(sockaddr_in& address) {
    const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    address = {};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t length = sizeof address;
    auto* generic = static_cast<sockaddr*>(static_cast<void*>(&address));
    // A lost datagram must not hang the measurement.
    const timeval patience{0, 200'000};
    if (descriptor < 0 || bind(descriptor, generic, length) != 0 ||
        getsockname(descriptor, generic, &length) != 0 ||
        setsockopt(descriptor, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience) != 0) {
        throw Error(ExitCode::kNetwork, "cannot measure the round trip over loopback UDP: {}{}",
                    std::strerror(errno), descriptor_advice(errno));
    }
    return descriptor;
}

void connect_to(int descriptor, const sockaddr_in& address) {
    const auto* generic = static_cast<const sockaddr*>(static_cast<const void*>(&address));
    if (connect(descriptor, generic, sizeof address) != 0) {
        throw Error(ExitCode::kNetwork, "cannot measure the round trip over loopback UDP: {}{}",
                    std::strerror(errno), descriptor_advice(errno));
    }
}

// Ends when no question has come for a while.
[[noreturn]] void echo(int descriptor, const RuntimeSettings& settings) {
    ask_for_realtime(settings);
    std::array<std::uint8_t, kBytes> buffer{};
    for (int misses = 0; misses < 5;) {
        const auto size = recv(descriptor, buffer.data(), buffer.size(), 0);
        if (size <= 0) {
            ++misses;
        } else {
            misses = 0;
            send(descriptor, buffer.data(), static_cast<std::size_t>(size), 0);
        }
    }
    _exit(0);
}

Histogram exchange(int descriptor, int exchanges) {
    Histogram histogram;
    std::array<std::uint8_t, kBytes> buffer{};
    for (int i = 0; i < exchanges; ++i) {
        wall_sleep(std::chrono::milliseconds{1});
        const SessionTime start = wall_now();
        send(descriptor, buffer.data(), buffer.size(), 0);
        if (recv(descriptor, buffer.data(), buffer.size(), 0) > 0) histogram.add(wall_now() - start);
    }
    return histogram;
}

}  // namespace

Histogram measure_ping_pong(const RuntimeSettings& settings, int exchanges) {
    sockaddr_in here{}, there{};
    const int mine = loopback_socket(here), theirs = loopback_socket(there);
    connect_to(mine, there);
    connect_to(theirs, here);
    const pid_t child = fork();
    if (child == 0) echo(theirs, settings);
    close(theirs);
    Histogram histogram;
    if (child > 0) {
        // A thread of its own, so that this program keeps its scheduling.
        std::thread([&] {
            ask_for_realtime(settings);
            histogram = exchange(mine, exchanges);
        }).join();
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
    }
    close(mine);
    return histogram;
}

}  // namespace thimble
