#include "tests/loopback/relay/relay_program.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <poll.h>
#include <stdexcept>
#include <unistd.h>

#include "common/runtime/wall_clock.hpp"
#include "netem/relay/datagram_batch.hpp"

namespace thimble {
namespace {

bool readable(const UdpSocket& socket, Duration patience) {
    pollfd wanted{socket.descriptor(), POLLIN, 0};
    return poll(&wanted, 1, static_cast<int>(patience / std::chrono::milliseconds{1})) > 0;
}

void send(const UdpSocket& socket, Bytes bytes, const UdpAddress* to) {
    SendBatch batch;
    batch.add(bytes, to);
    batch.send(socket.descriptor());
}

}  // namespace

UdpAddress loopback() { return {htonl(INADDR_LOOPBACK), 0}; }

NetemProgram::NetemProgram(const std::vector<std::string>& arguments)
    : printed_(open((folder_ / "out").c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0600)),
      child_(std::filesystem::path(THIMBLE_BIN_DIR) / "thimble-netem", arguments, folder_ / "err",
             {.output = printed_}) {}

NetemProgram::~NetemProgram() { close(printed_); }

UdpAddress NetemProgram::inlet(int n) {
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

Ended run_netem(const std::vector<std::string>& arguments) {
    NetemProgram program(arguments);
    const int code = program.wait();
    return {code, program.printed(), program.said()};
}

EchoServer::EchoServer() : socket_(UdpSocket::listening(loopback())) {
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

EchoServer::~EchoServer() {
    stop_ = true;
    thread_.join();
}

void Client::say(const std::string& words) const {
    send(socket_, {reinterpret_cast<const std::uint8_t*>(words.data()), words.size()}, nullptr);
}

std::optional<std::string> Client::hear(Duration patience) const {
    // One at a time: what else waits is for the next call.
    std::string words(65536, '\0');
    if (!readable(socket_, patience)) return std::nullopt;
    const auto size = recv(socket_.descriptor(), words.data(), words.size(), 0);
    if (size < 0) return std::nullopt;
    words.resize(static_cast<std::size_t>(size));
    return words;
}

std::optional<Duration> Client::round_trip(const std::string& words) const {
    const SessionTime start = wall_now();
    say(words);
    if (hear() != words) return std::nullopt;
    return wall_now() - start;
}

}  // namespace thimble
